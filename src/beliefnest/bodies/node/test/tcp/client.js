'use strict'
/**
 * Connects to a Minecraft server over TCP, as an agent that knows only its region's coordinates
 * and agents' names: packets are translated on this side of the wire.
 */
const minecraft = require('minecraft-protocol')
const { Translator } = require('../../src/net/translate')
const versions = require('../../src/versions')

/**
 * @param {object} options
 * @param {number} options.port
 * @param {string} options.username as the server is to know the player
 * @param {string} options.agent as the bot is to know itself
 * @param {{x: number, z: number}} options.origin where scenario (0, y, 0) lies on the server
 * @param {Map<string, string>} options.agentOf agent by the server's name of a player
 * @returns {import('minecraft-protocol').Client}
 */
function connect ({ port, username, agent, origin, agentOf }) {
  const translator = new Translator(origin, agentOf)
  const client = minecraft.createClient({
    host: '127.0.0.1', port, username, version: versions.minecraft, auth: 'offline', hideErrors: true
  })
  client.setMaxListeners(0)
  client.once('success', () => { client.username = agent })
  translateOutgoing(client, translator)
  translateIncoming(client, translator)
  return client
}

function translateOutgoing (client, translator) {
  const write = client.write
  client.write = function (name, params) {
    return write.call(this, name, this.state === 'play' ? translator.toServer(name, params) : params)
  }
}

// A packet is emitted under several names; all who listen get the same object.
function translateIncoming (client, translator) {
  const emit = client.emit
  const translated = new WeakMap()
  client.emit = function (event, params, meta, ...rest) {
    if (meta?.state !== 'play' || params === null || typeof params !== 'object') return emit.call(this, event, params, meta, ...rest)
    if (!translated.has(params)) translated.set(params, translator.toClient(meta.name, params))
    return emit.call(this, event, translated.get(params), meta, ...rest)
  }
}

module.exports = { connect }
