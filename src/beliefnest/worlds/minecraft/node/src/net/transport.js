'use strict'
/**
 * Minecraft connections inside one process: packets are handed over as objects, in order, without sockets, compression
 * or encryption. Both ends look like node-minecraft-protocol clients that have reached the `play` state.
 */
const { End, handOver } = require('./end')

// Limit of packets that a bot may send before the other side has received any. Without it some loops of Mineflayer,
// which wait for a window that was closed meanwhile, would never let time pass.
const MOST_AT_ONCE = 5000

// Packets with a bot's position.
const MOVES = ['position', 'position_look']

class MemoryEnd extends End {
  /**
   * @param {object} link properties that both ends share: `version`, `supportFeature`, `mail`, `report(error)`
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
   * Send a packet. The other end receives it after the current code has finished.
   * @throws {Error} if a bot sends endlessly
   */
  write (name, params) {
    if (this.ended) return
    this.checkRoom(name)
    const translated = this.translate(name, params)
    if (translated !== null) this.link.mail.post([this.peer], name, translated)
  }

  writeBundle (packets) {
    for (const [name, params] of packets) this.write(name, params)
  }

  /** End both ends at once. */
  end (reason) {
    if (this.ended) return
    this.ended = true
    this.peer.end(reason)
    this.emit('end', reason)
  }

  /** Ignore plugin channels: scenarios do not use them. */
  registerChannel () {}
  unregisterChannel () {}
  writeChannel () {}
}

class ClientEnd extends MemoryEnd {
  most = MOST_AT_ONCE
  isCut = false
  // Number in the order of connecting.
  number = 0

  /** Let nothing through any more except the bot's position, because it still falls. */
  cut () {
    this.isCut = true
  }

  write (name, params) {
    if (!this.isCut) super.write(name, params)
    else if (MOVES.includes(name)) super.write('position', params)
  }

  /**
   * Let an action of the host send packets beyond the bot's limit: the packets that stop a bot must reach the server.
   */
  beyond (action) {
    this.most = Infinity
    try {
      action()
    } finally {
      this.most = MOST_AT_ONCE
    }
  }

  /** Set whether packets of others' moves are delivered; their appearance changes in any case (bots/others.js). */
  watch (wanted) {
    this.link.mail.watch(this, wanted)
  }

  checkRoom (name) {
    if (this.peer.expected >= this.most) throw new Error(`${MOST_AT_ONCE} packets were sent at once, the last of them ${name}; the bot waits for something that does not happen`)
  }

  /** Send a line that a player types: a command or a chat message. */
  chat (message) {
    if (message.startsWith('/')) this.write('chat_command', { command: message.slice(1) })
    else this.write('chat_message', { message })
  }

  deliver (name, params) {
    if (name === 'system_chat') {
      const formattedMessage = JSON.stringify(this.link.readChat(params.content))
      this.emit('systemChat', { formattedMessage, positionId: params.isActionBar ? 2 : 1 })
    }
    this.emit(name, params)
  }
}

class ServerEnd extends MemoryEnd {
  checkRoom () {}

  /** Send one packet to several players of one region, as `write` to each of them, but translated only once. */
  static writeToAll (ends, name, params) {
    const open = ends.filter(end => !end.ended)
    if (open.length === 0) return
    const [first] = open
    first.link.mail.post(open.map(end => end.peer), name, first.translate(name, params))
  }

  deliver (name, params) {
    handOver(this, name, params, this.link.report)
  }
}

/** Queue of the packets of one region, which keeps them in order. */
class Mail {
  /**
   * @param {(owner: string, action: function(): void) => void} run handles a packet in the name of the agent that
   *   owns the connection, whoever sent the packet, and catches errors
   * @param {(error: Error, owner: string) => void} report called with errors that such code throws later
   */
  constructor (run, report) {
    this.run = run
    this.report = report
    this.waiting = []
    this.scheduled = false
    // Ends of bots to which packets of others' moves are delivered, in the order in which they joined.
    this.watching = []
    this.connected = 0
  }

  /** Add an end to those that watch, or remove it. */
  watch (end, wanted) {
    const others = this.watching.filter(other => other !== end && !other.ended)
    this.watching = wanted ? [...others, end].sort((a, b) => a.number - b.number) : others
  }

  /** Queue a packet for some ends. */
  post (ends, name, params) {
    for (const end of ends) end.expected++
    this.queue({ ends, name, params, appearance: null, mover: null })
  }

  /**
   * Queue a move of a player for all bots of the region.
   * @param {import('./appearance').Appearance} appearance appearance that it changes
   * @param {ClientEnd} [mover] end of the moving player's own bot
   */
  postMove (appearance, mover, name, params) {
    this.queue({ ends: [], name, params, appearance, mover })
  }

  queue (packet) {
    this.waiting.push(packet)
    if (this.scheduled) return
    this.scheduled = true
    // Do not deliver earlier: a sender may first write and then, some promises later, listen for the answer.
    setImmediate(() => this.handOver())
  }

  /** Drop packets that have not arrived yet. */
  clear () {
    this.waiting.length = 0
    this.scheduled = false
  }

  handOver () {
    for (let index = 0; index < this.waiting.length; index++) {
      const { ends, name, params, appearance, mover } = this.waiting[index]
      for (const end of ends) {
        end.expected--
        this.deliver(end, name, params)
      }
      if (appearance === null) continue
      appearance.move(name, params)
      for (const end of this.watching) if (end !== mover) this.deliver(end, name, params)
    }
    this.waiting.length = 0
    this.scheduled = false
  }

  deliver (end, name, params) {
    if (!end.ended) this.run(end.link.agent, () => end.deliver(name, params))
  }
}

/**
 * Connect a player to the server in memory.
 * @param {object} options
 * @param {import('prismarine-registry').Registry} options.registry registry of the Minecraft version
 * @param {Mail} options.mail queue of the region
 * @param {import('./translate').Translator} options.translator translation between the two sides
 * @param {string} options.username name of the player on the server
 * @param {string} options.agent name of the player on the client
 * @param {string} options.uuid
 * @param {(content: object) => object} options.readChat returns a chat component from its NBT form
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
    mail
  }
  const client = new ClientEnd(link, agent, uuid)
  client.number = mail.connected++
  const server = new ServerEnd(link, username, uuid)
  client.peer = server
  server.peer = client
  client.translate = (name, params) => translator.toServer(name, params)
  server.translate = (name, params) => translator.toClient(name, params)
  return { client, server }
}

module.exports = { connect, Mail, ServerEnd }
