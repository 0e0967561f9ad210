'use strict'
/**
 * Connects to a Minecraft server over TCP, as an agent that knows only its region's coordinates
 * and agents' names: packets are translated on this side of the wire.
 */
const minecraft = require('minecraft-protocol')
const { OFFLINE, requireName } = require('./accounts')
const { Translator } = require('../net/translate')

// Milliseconds without a sign of the server after which a connection counts as lost.
const SILENCE_MS = 30_000

/**
 * @param {object} options
 * @param {string} [options.host]
 * @param {number} options.port
 * @param {string} options.version of Minecraft, one of those held
 * @param {string} options.username as the server is to know the player
 * @param {string} [options.agent] as the bot is to know itself
 * @param {{x: number, z: number}} options.origin where scenario (0, y, 0) lies on the server
 * @param {Map<string, string>} [options.agentOf] agent by the server's name of a player
 * @param {object} [options.login] how to, of accounts.js
 * @param {Set<string>} [options.hidden] names of players that the bot is not to know of, as long as they are in it
 * @returns {import('minecraft-protocol').Client} which emits `sent` (name, params) for every packet that its bot
 *   sends, as the bot means it
 */
function connect ({ host = '127.0.0.1', port, version, username, agent = username, origin, agentOf = new Map(), hidden = new Set(), login = OFFLINE }) {
  const translator = new Translator(origin, agentOf)
  const client = minecraft.createClient({
    host, port, username, version, ...login, hideErrors: true, checkTimeoutInterval: SILENCE_MS
  })
  client.setMaxListeners(0)
  requireName(client, username)
  client.once('success', () => { client.username = agent })
  translateOutgoing(client, translator)
  translateIncoming(client, translator, hidden)
  return client
}

function translateOutgoing (client, translator) {
  const write = client.write
  client.write = function (name, params) {
    if (this.state !== 'play') return write.call(this, name, params)
    this.emit('sent', name, params)
    return write.call(this, name, translator.toServer(name, params))
  }
}

// A packet is emitted under several names; all who listen get the same object.
function translateIncoming (client, translator, hidden) {
  const emit = client.emit
  const translated = new WeakMap()
  const shown = (name, packet) => name !== 'player_info' || hidden.size === 0
    ? packet
    : { ...packet, data: packet.data.filter(({ player }) => !hidden.has(player?.name)) }
  client.emit = function (event, params, meta, ...rest) {
    const isPacket = meta?.state === 'play' && params !== null && typeof params === 'object' && !Buffer.isBuffer(params)
    if (!isPacket) return emit.call(this, event, params, meta, ...rest)
    if (!translated.has(params)) translated.set(params, shown(meta.name, translator.toClient(meta.name, params)))
    return emit.call(this, event, translated.get(params), meta, ...rest)
  }
}

module.exports = { connect }
