'use strict'
/**
 * Minecraft connections inside one process: packets are handed over as objects, in order,
 * without sockets, compression or encryption. Both ends look like node-minecraft-protocol
 * clients that have reached the `play` state.
 */
const { End, handOver } = require('./end')

// What a bot may send before the other side has taken any of it: some loops of Mineflayer that wait for a window
// which is closed meanwhile would go on without letting time pass.
const MOST_AT_ONCE = 5000

// Packets that say where a bot is.
const MOVES = ['position', 'position_look']

class MemoryEnd extends End {
  /**
   * @param {object} link what both ends share: `version`, `supportFeature`, `report(error)`
   * @param {string} username
   * @param {string} uuid
   */
  constructor (link, username, uuid) {
    super(username, uuid)
    this.link = link
    this.version = link.version
    this.protocolVersion = link.protocolVersion
    this.state = 'play'
    this.ended = false
    this.expected = 0
    this.settings = {}
    this.socket = { remoteAddress: 'memory', destroy () {} }
  }

  supportFeature (feature) {
    return this.link.supportFeature(feature)
  }

  /**
   * Send a packet; the other end gets it after the code that runs now.
   * @throws {Error} if a bot sends without end
   */
  write (name, params) {
    if (this.ended) return
    this.checkRoom(name)
    this.link.post(this.peer, name, this.translate(name, params))
  }

  writeBundle (packets) {
    for (const [name, params] of packets) this.write(name, params)
  }

  /** End both sides at once. */
  end (reason) {
    if (this.ended) return
    this.ended = true
    this.peer.end(reason)
    this.emit('end', reason)
  }

  /** Plugin channels carry nothing a scenario knows of. */
  registerChannel () {}
  unregisterChannel () {}
  writeChannel () {}
}

class ClientEnd extends MemoryEnd {
  most = MOST_AT_ONCE
  isCut = false

  /** Let nothing through any more but where the bot is, which falls as long as it is in the air. */
  cut () {
    this.isCut = true
  }

  write (name, params) {
    if (!this.isCut) super.write(name, params)
    else if (MOVES.includes(name)) super.write('position', params)
  }

  /** Let an action of the host send on, however much the bot has sent: what stops a bot must reach the server. */
  beyond (action) {
    this.most = Infinity
    try {
      action()
    } finally {
      this.most = MOST_AT_ONCE
    }
  }

  checkRoom (name) {
    if (this.peer.expected >= this.most) throw new Error(`${MOST_AT_ONCE} packets were sent at once, the last of them ${name}; the bot waits for what does not happen`)
  }

  /** What a player types: a command or words. */
  chat (message) {
    if (message.startsWith('/')) this.write('chat_command', { command: message.slice(1) })
    else this.write('chat_message', { message })
  }

  deliver (name, params) {
    if (name === 'system_chat') {
      const formattedMessage = JSON.stringify(this.link.readChat(params.content))
      this.emit('systemChat', { formattedMessage, positionId: params.isActionBar ? 2 : 1 })
    }
    this.emit('packet', params, { name, state: 'play' })
    this.emit(name, params, { name, state: 'play' })
  }
}

class ServerEnd extends MemoryEnd {
  checkRoom () {}

  deliver (name, params) {
    handOver(this, name, params, this.link.report)
  }
}

/** A queue for the packets of one region, so that they arrive in the order they were sent. */
class Mail {
  /**
   * @param {(owner: string, action: function(): void) => void} run runs what a packet of an agent's connection,
   *   in either direction, leads to, and hears what that throws
   * @param {(error: Error, owner: string) => void} report hears what such code throws later
   */
  constructor (run, report) {
    this.run = run
    this.report = report
    this.waiting = []
    this.scheduled = false
  }

  post (end, name, params) {
    if (params === null) return
    this.waiting.push({ end, name, params })
    end.expected++
    if (this.scheduled) return
    this.scheduled = true
    // Not sooner: a sender may first write and then, some promises later, listen for the answer.
    setImmediate(() => this.handOver())
  }

  /** Drop what was sent and has not arrived. */
  clear () {
    this.waiting.length = 0
    this.scheduled = false
  }

  handOver () {
    for (let index = 0; index < this.waiting.length; index++) {
      const { end, name, params } = this.waiting[index]
      end.expected--
      if (!end.ended) this.run(end.link.agent, () => end.deliver(name, params))
    }
    this.waiting.length = 0
    this.scheduled = false
  }
}

/**
 * @param {object} options
 * @param {import('prismarine-registry').Registry} options.registry of the Minecraft version
 * @param {Mail} options.mail of the region
 * @param {import('./translate').Translator} options.translator between the two sides
 * @param {string} options.username as the server knows the player
 * @param {string} options.agent as the client knows itself
 * @param {string} options.uuid
 * @param {(content: object) => object} options.readChat chat component from its NBT form
 * @returns {{client: ClientEnd, server: ServerEnd}}
 */
function connect ({ registry, mail, translator, username, agent, uuid, readChat }) {
  const link = {
    version: registry.version.minecraftVersion,
    protocolVersion: registry.version.version,
    supportFeature: registry.supportFeature,
    readChat,
    agent,
    report: error => mail.report(error, agent),
    post: (end, name, params) => mail.post(end, name, params)
  }
  const client = new ClientEnd(link, agent, uuid)
  const server = new ServerEnd(link, username, uuid)
  client.peer = server
  server.peer = client
  client.translate = (name, params) => translator.toServer(name, params)
  server.translate = (name, params) => translator.toClient(name, params)
  return { client, server }
}

module.exports = { connect, Mail }
