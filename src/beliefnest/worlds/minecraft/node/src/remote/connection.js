'use strict'
/**
 * Connection of a bot to a Minecraft server over TCP. The bot uses the coordinates of its region and the names of
 * agents; the connection translates its packets to those of the server, and back.
 */
const minecraft = require('minecraft-protocol')
const { OFFLINE, requireName } = require('./accounts')
const { Translator } = require('../net/translate')

// Milliseconds of silence, in this process's own time (time/ownTime.js), after which a connection counts as lost.
const SILENCE_MS = 30_000

/**
 * Connect a player.
 * @param {object} options
 * @param {string} [options.host]
 * @param {number} options.port
 * @param {string} options.version version of Minecraft; this build must have its data
 * @param {string} options.username name of the player on the server
 * @param {string} [options.agent] name of the player in the bot's own view
 * @param {{x: number, z: number}} options.origin server position of scenario (0, y, 0)
 * @param {Map<string, string>} [options.agentOf] names of agents, by the names of their players on the server
 * @param {object} [options.login] login options from accounts.js
 * @param {Set<string>} [options.hidden] names of players that the bot must not see; the set may change
 * @returns {import('minecraft-protocol').Client} client that emits `sent` (name, params) for every packet of its bot,
 *   before the translation
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

// A packet is emitted under several names; translate it once, so that all listeners get the same object.
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
