'use strict'
/**
 * Observer of one agent's connection to a remote server: sent packets are the agent's attempts, received packets are
 * their results. The plugins for acts and reports use it like a player of the embedded server.
 */
const { EventEmitter } = require('node:events')
const { Vec3 } = require('vec3')
const acts = require('../server/plugins/acts')
const reports = require('../server/plugins/reports')
const { vecOf } = require('../server/plugins/lib/positions')
const { Windows } = require('./windows')

const WHISPER = /^(?:tell|msg|w) (\S+) (.+)$/s
const DIG = { START: 0, CANCEL: 1, FINISH: 2, DROP_STACK: 3, DROP_ONE: 4 }
// Number of ticks in which the server answers an agent's attempt.
const ANSWERED_WITHIN = 60

class Witness extends EventEmitter {
  /**
   * @param {string} agent
   * @param {import('../regions/place').Place} region
   * @param {import('./scene').Scene} scene
   * @param {object} Item Item class of the version
   */
  constructor (agent, region, scene, Item) {
    super()
    this.setMaxListeners(0)
    this.agent = agent
    this.region = region
    this.scene = scene
    this.bot = null
    // The person who plays this agent, visible only to the operator; null if a bot does.
    this.person = null
    // Latest attempts on blocks: {position, at, kind}, the latest first; `at` is in ticks that the region followed.
    this.tries = []
    this.used = null
    this.usedAt = -Infinity
    this.windows = new Windows(this, scene, Item)
    this.stoodAt = new Vec3(0, 0, 0)
    acts.player(this)
    reports.player(this, scene.serv)
  }

  get followed () {
    return this.region.followed
  }

  /** Return the agent's position; for a bot that is reconnecting, its last one. */
  get position () {
    return (this.person ?? this.bot).entity?.position ?? this.stoodAt
  }

  emitEvent ({ kind, detail }) {
    this.region.recorder.event({ kind, actor: this.agent, detail })
    this.emit('event', { kind, detail })
  }

  /** Listen to a connection from its first packet on. */
  attach (bot, client) {
    this.bot = bot
    this.windows.reset()
    const sent = { block_dig: packet => this.dig(packet), block_place: packet => this.use(packet), window_click: packet => this.windows.click(packet), close_window: () => this.windows.close(), update_sign: ({ location }) => this.try('write', vecOf(location)), chat_command: ({ command }) => this.command(command), chat_command_signed: ({ command }) => this.command(command), chat_message: ({ message }) => this.scene.expect({ actor: this.agent, text: message }) }
    client.on('sent', (name, packet) => sent[name]?.(packet))
    client.on('open_window', packet => this.windows.open(packet))
    client.on('window_items', packet => this.windows.show(packet))
    client.on('set_slot', packet => this.windows.showSlot(packet))
    client.on('close_window', () => this.windows.close())
    bot.on('messagestr', text => this.scene.heardBy(this.agent, text))
    bot.on('whisper', (speaker, text) => this.scene.people.said(speaker, text, this.agent))
  }

  lookedAt () {
    return this.used
  }

  try (kind, position) {
    this.tries.unshift({ kind, position, at: this.followed })
    this.tries = this.tries.filter(({ at }) => this.followed - at <= ANSWERED_WITHIN)
  }

  /**
   * Return true if this agent attempted this kind of act at the position a moment ago; the attempt is then used up.
   */
  hasTried (kind, position) {
    const index = this.tries.findIndex(each => each.kind === kind && each.position.equals(position) && this.followed - each.at <= ANSWERED_WITHIN)
    if (index < 0) return false
    this.tries.splice(index, 1)
    return true
  }

  /**
   * Return true if the agent has used the block and the server may not have answered yet, or its window shows the
   * block's contents.
   */
  usesNow (position) {
    return this.windows.shows(position) || (this.used !== null && this.used.equals(position) && this.followed - this.usedAt <= ANSWERED_WITHIN)
  }

  dig ({ status, location }) {
    if (status === DIG.START || status === DIG.FINISH) this.try('dig', vecOf(location))
    if (status !== DIG.DROP_STACK && status !== DIG.DROP_ONE) return
    const stack = this.bot.heldItem
    if (stack) this.threw(status === DIG.DROP_ONE ? Object.assign(Object.create(stack), { count: 1 }) : stack)
  }

  use ({ location }) {
    this.used = vecOf(location)
    this.usedAt = this.followed
    this.try('use', this.used)
  }

  threw (item) {
    this.scene.thrown.push({ agent: this.agent, name: item.name, count: item.count, at: this.followed })
  }

  command (command) {
    const [, to, text] = WHISPER.exec(command) ?? []
    if (text !== undefined) this.scene.expect({ actor: this.agent, text, to })
  }

  /** Report the acts counted in a tick; called at its end. */
  endTick () {
    this.uttered = 0
    this.windows.settle()
    this.tellActs()
  }

  /** Report that unfinished acts ended with the agent's program. */
  rest () {
    this.emit('rest')
  }
}

module.exports = { Witness }
