'use strict'
/** The bot that serves a place on a server elsewhere: it types commands, and its client is what the place looks like. */
const { once } = require('node:events')
const { Vec3 } = require('vec3')
const { EYE_HEIGHT } = require('../../../../programs/skills/lib/sight')
const { NEEDED } = require('./commands')
const reasons = require('./reasons')
const { ByCompletions } = require('./settling')
const { parseSnbt } = require('./snbt')
const { until } = require('./waiting')

const ANSWER_MS = 5000
const MOST_LINES = 20
const TOP = 1
// How many commands are typed before the server's answer is awaited: the more, the sooner it answers.
const FEWEST_AT_ONCE = 8
const MOST_AT_ONCE = 256
const FIRST_AT_ONCE = 32
const SOON_MS = 150
const LATE_MS = 1000
// How a server answers `/data get`, in every version of the game that has it.
const DATA = /^.{1,200}? has the following (?:block|entity) data: (.+)$/s

class Operator {
  /**
   * @param {import('./link').Link} link
   * @param {object} server what reasons.js tells of it
   * @param {object} [settling] of settling.js
   */
  constructor (link, server, settling = new ByCompletions()) {
    this.link = link
    this.server = server
    this.settling = settling
    this.lines = []
    // The question that is asked last: answers do not say to which one they are.
    this.asked = Promise.resolve()
    this.commandNames = null
    this.atOnce = FIRST_AT_ONCE
    link.on('begun', (bot, client) => {
      this.commandNames = null
      client.on('declare_commands', packet => { this.commandNames = namesOf(packet) })
      bot.on('messagestr', text => { this.lines = [...this.lines, text].slice(-MOST_LINES) })
    })
  }

  get bot () {
    return this.link.bot
  }

  /** Types a command; what comes of it is looked at elsewhere. */
  type (command) {
    this.settling.type(this.bot, command)
  }

  /**
   * Types commands, as fast as the server does what they say; it may send away who is faster.
   * @throws {Unplayable} if the server does not answer within its patience
   */
  async typeAll (commands) {
    for (let next = 0; next < commands.length;) {
      for (const command of commands.slice(next, next + this.atOnce)) this.type(command)
      next += this.atOnce
      const asked = performance.now()
      await this.settled()
      const took = performance.now() - asked
      if (took < SOON_MS) this.atOnce = Math.min(2 * this.atOnce, MOST_AT_ONCE)
      else if (took > LATE_MS) this.atOnce = Math.max(Math.floor(this.atOnce / 2), FEWEST_AT_ONCE)
    }
  }

  can (name) {
    return this.commandNames?.has(name) ?? false
  }

  /** @throws {Unplayable} if what is needed cannot be typed */
  async requireRights () {
    if (!await this.until(() => this.commandNames !== null)) throw reasons.noCommands(this.server)
    const lacking = NEEDED.filter(name => !this.can(name))
    if (lacking.length > 0) throw reasons.noOperator(this.server, lacking)
  }

  /**
   * Resolves when the server has done what was typed before and has told of it.
   * @throws {Unplayable} if the server does not answer within its patience
   */
  async settled () {
    const patience = this.server.patience * 1000
    const end = performance.now() + patience
    while (performance.now() < end) {
      if (!this.link.isHere) await this.link.present()
      if (await this.settling.settled(this.bot, Math.min(patience, ANSWER_MS))) return
    }
    throw reasons.stalled(this.server, this.server.patience)
  }

  /**
   * @param {string} command a `/data get`
   * @returns {Promise<object | Array | null>} the data; null if the server gives none that can be read
   */
  ask (command) {
    const answer = this.asked.catch(() => {}).then(() => this.askNow(command))
    this.asked = answer
    return answer
  }

  async askNow (command) {
    const answers = []
    const { bot } = this
    const hear = text => { if (DATA.test(text)) answers.push(DATA.exec(text)[1]) }
    bot.on('messagestr', hear)
    this.type(command)
    try {
      await this.settled()
    } finally {
      bot.off('messagestr', hear)
    }
    try {
      return answers.length === 0 ? null : parseSnbt(answers.at(-1))
    } catch (error) {
      if (error instanceof SyntaxError) return null
      throw error
    }
  }

  /** @returns {Promise<boolean>} whether the condition held in time */
  async until (condition, milliseconds = ANSWER_MS) {
    return until(condition, milliseconds)
  }

  /**
   * @param {import('../regions/box').Box} box
   * @param {import('./versions').BlockMapping} mapping
   * @returns {Int32Array} the states of a box, in its array order, as our version counts them
   */
  readStates (box, mapping) {
    const states = new Int32Array(box.size)
    const place = new Vec3(0, 0, 0)
    box.forEach((x, y, z, index) => {
      place.set(x, y, z)
      states[index] = mapping.fromServer(this.bot.world.getBlockStateId(place))
    })
    return states
  }

  /** Resolves when the operator's client is at a place. */
  async go (command, [x, y, z]) {
    const there = new Vec3(x, y, z)
    this.type(command)
    return this.until(() => this.bot.entity.position.distanceTo(there) < 1)
  }

  /**
   * Looks into a container from above.
   * @param {object} commands of commandsFor
   * @returns {Promise<Array | null>} its stacks by slot; null if it does not open
   */
  async lookInto (commands, [x, y, z]) {
    const { bot } = this
    const place = [x + 0.5, y + 1.5 - EYE_HEIGHT, z + 0.5]
    await this.go(commands.go(this.link.name, place, { yaw: 0, pitch: -Math.PI / 2 }), place)
    const opened = once(bot, 'windowOpen', { signal: AbortSignal.timeout(ANSWER_MS) }).catch(() => null)
    bot._client.write('block_place', {
      location: new Vec3(x, y, z), direction: TOP, hand: 0, cursorX: 0.5, cursorY: 1, cursorZ: 0.5, insideBlock: false, sequence: 0
    })
    const answer = await opened
    if (answer === null) return null
    const [window] = answer
    const stacks = window.slots.slice(0, window.inventoryStart)
    bot.closeWindow(window)
    return stacks
  }
}

/** Names of the commands that a player may type. */
function namesOf ({ nodes, rootIndex }) {
  return new Set(nodes[rootIndex].children.map(index => nodes[index].extraNodeData?.name))
}

module.exports = { Operator }
