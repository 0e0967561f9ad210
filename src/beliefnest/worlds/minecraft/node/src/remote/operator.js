'use strict'
/** Bot that manages a place on a remote server: it types commands, and its client shows the state of the place. */
const { setTimeout: sleep } = require('node:timers/promises')
const { Vec3 } = require('vec3')
const { EYE_HEIGHT } = require('../../../../../skills/code/lib/sight')
const { Assembly } = require('../regions/assembly')
const { NEEDED } = require('./commands')
const reasons = require('./reasons')
const { ByCompletions } = require('./settling')
const { parseSnbt } = require('./snbt')

const POLL_MS = 10
// Number of server ticks after which an answer or effect is no longer expected.
const ANSWER_TICKS = 100
const TICKS_PER_SECOND = 20
// Number of ticks after which the user is told about a wait.
const PATIENT_TICKS = 40
const MOST_LINES = 20
const TOP = 1
const CHUNK_BITS = 4
// Number of commands that are typed before the operator waits for the server. It grows while the server answers
// quickly.
const FEWEST_AT_ONCE = 8
const MOST_AT_ONCE = 256
const FIRST_AT_ONCE = 32
const SOON_MS = 150
const LATE_MS = 1000
// Answer of a server to `/data get`, in every version that has the command.
const DATA = /^.{1,200}? has the following (?:block|entity) data: (.+)$/s

class Operator {
  /**
   * @param {import('./link').Link} link
   * @param {object} server server, as in reasons.js
   * @param {import('./serverClock').ServerClock} clock set by the operator's connection
   * @param {object} [settling] see settling.js
   */
  constructor (link, server, clock, settling = new ByCompletions()) {
    this.link = link
    this.server = server
    this.clock = clock
    this.settling = settling
    this.lines = []
    // Last question. Questions are asked one at a time, because answers do not say to which one they belong.
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

  /** Type a command; its effect is checked elsewhere. */
  type (command) {
    this.settling.type(this.bot, command)
  }

  /**
   * Type commands as fast as the server executes them; a server may kick a faster player.
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

  /** Return the number of ticks in which the server has to react. */
  get patienceTicks () {
    return this.server.patience * TICKS_PER_SECOND
  }

  /**
   * Wait until the operator may use the required commands. A server may send its list of commands in several parts.
   * @param {(text: string) => void} tell shows a text to the user
   * @throws {Unplayable} if rights are missing after the patience
   */
  async requireRights (tell) {
    const lacking = () => NEEDED.filter(name => !this.can(name))
    const isComplete = () => lacking().length === 0
    if (!await this.until(isComplete, Math.min(PATIENT_TICKS, this.patienceTicks))) tell(reasons.waitingForCommands(this.server, lacking()))
    if (await this.until(isComplete, this.patienceTicks)) return
    throw this.commandNames === null ? reasons.noCommands(this.server) : reasons.noOperator(this.server, lacking())
  }

  /**
   * Resolve when the server has executed all typed commands and sent their effects.
   * @throws {Unplayable} if the server does not answer within its patience
   */
  async settled () {
    const due = this.clock.followed + this.patienceTicks
    while (this.clock.followed <= due) {
      if (!this.link.isHere) await this.link.present()
      if (await this.hasSettled(this.bot, ANSWER_TICKS)) return
    }
    throw reasons.stalled(this.server, this.server.patience)
  }

  /**
   * Return true if the server has handled all packets of a player's client within a number of ticks.
   * @returns {Promise<boolean>}
   */
  hasSettled (bot, ticks) {
    return this.settling.settled(bot, (condition, limit) => this.until(condition, limit), ticks)
  }

  /**
   * Ask the server for data.
   * @param {string} command a `/data get` command
   * @returns {Promise<object | Array | null>} the data; null if the server sends none that can be parsed
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

  /**
   * Wait for an effect. For a slow server, or on a slow machine, the wait is longer.
   * @param {() => boolean} condition
   * @param {number} [ticks] number of server ticks that this process follows
   * @returns {Promise<boolean>} true if the condition held before that number of ticks had passed
   * @throws {Unplayable} if the server hangs, or the operator's connection is given up
   */
  async until (condition, ticks = ANSWER_TICKS) {
    const due = this.clock.followed + ticks
    while (!condition()) {
      this.requireServer()
      if (this.clock.followed > due) return false
      await sleep(POLL_MS)
    }
    return true
  }

  /** Fail if the server hangs or the operator's connection was given up. @throws {Unplayable} */
  requireServer () {
    const { link, server, clock } = this
    if (link.failure !== null) throw link.failure
    if (link.closed) throw reasons.left(server, link.name)
    if (link.isHere && clock.silence > server.patience * 1000) throw reasons.stalled(server, server.patience)
  }

  /**
   * Run an action that needs the operator's connection throughout, because typed commands are lost with it.
   * @param {() => Promise} action
   * @throws {Unplayable} as soon as the connection is lost
   */
  async attended (action) {
    const { link, server } = this
    const { promise, reject } = Promise.withResolvers()
    const fail = reason => reject(reasons.cutOff(server, link.name, reason))
    link.on('lost', fail)
    try {
      return await Promise.race([link.present().then(action), promise])
    } finally {
      link.off('lost', fail)
    }
  }

  /**
   * Wait until a player has received a box. The wait goes on as long as more of the box arrives.
   * @returns {Promise<boolean>} true if all of it has arrived
   */
  async shown (bot, box, ticks) {
    for (let lacking = columnsLacking(bot, box); lacking > 0; lacking = columnsLacking(bot, box)) {
      const before = lacking
      if (!await this.until(() => columnsLacking(bot, box) < before, ticks)) return false
    }
    return true
  }

  /**
   * Return the states of a box in our version's numbers.
   * @param {import('../regions/box').Box} box
   * @param {import('./versions').BlockMapping} mapping
   * @returns {Int32Array} in the box's array order
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

  /**
   * Return the blocks of a box, in our version's numbers; takes memory for its different cubes only.
   * @param {import('../regions/box').Box} box
   * @param {{side: number, margin: number}} cut how it is cut into cubes (Assembly)
   * @param {import('./versions').BlockMapping} mapping
   * @returns {import('../regions/terrain').Terrain}
   */
  readTerrain (box, cut, mapping) {
    const { world } = this.bot
    const assembly = new Assembly(box, cut, 0)
    const { side, first, counts, volume } = assembly
    const states = new Int32Array(volume)
    for (let i = 0; i < counts[0]; i++) {
      for (let k = 0; k < counts[2]; k++) {
        for (let j = 0; j < counts[1]; j++) {
          const low = [i, j, k].map((number, axis) => first[axis] + number * side)
          readCube(world, low, side, box, states, mapping)
          assembly.put([i, j, k], states)
        }
      }
    }
    return assembly.terrain()
  }

  /** Resolve when the operator's client is at a position. */
  async go (command, [x, y, z]) {
    const there = new Vec3(x, y, z)
    this.type(command)
    return this.until(() => this.bot.entity.position.distanceTo(there) < 1)
  }

  /**
   * Look into a container from above.
   * @param {object} commands of commandsFor
   * @returns {Promise<Array | null>} stacks by slot; null if it does not open
   */
  async lookInto (commands, [x, y, z]) {
    const { bot } = this
    const place = [x + 0.5, y + 1.5 - EYE_HEIGHT, z + 0.5]
    await this.go(commands.go(this.link.name, place, { yaw: 0, pitch: -Math.PI / 2 }), place)
    let window = null
    const open = opened => { window = opened }
    bot.once('windowOpen', open)
    bot._client.write('block_place', {
      location: new Vec3(x, y, z), direction: TOP, hand: 0, cursorX: 0.5, cursorY: 1, cursorZ: 0.5, insideBlock: false, sequence: 0
    })
    await this.until(() => window !== null).finally(() => bot.off('windowOpen', open))
    if (window === null) return null
    const stacks = window.slots.slice(0, window.inventoryStart)
    bot.closeWindow(window)
    return stacks
  }
}

/** Read the states of a cube; those outside the box are 0. */
function readCube (world, low, side, box, states, mapping) {
  states.fill(0)
  const from = low.map((value, axis) => Math.max(value, box.low[axis]))
  const to = low.map((value, axis) => Math.min(value + side - 1, box.high[axis]))
  for (let x = from[0]; x <= to[0]; x++) {
    for (let z = from[2]; z <= to[2]; z++) {
      const column = world.getColumn(x >> CHUNK_BITS, z >> CHUNK_BITS)
      const place = { x: x & (1 << CHUNK_BITS) - 1, y: from[1], z: z & (1 << CHUNK_BITS) - 1 }
      for (let index = ((x - low[0]) * side + from[1] - low[1]) * side + z - low[2]; place.y <= to[1]; place.y++, index += side) {
        states[index] = mapping.fromServer(column.getBlockStateId(place))
      }
    }
  }
}

/** Return the names of the commands that a player may use. */
function namesOf ({ nodes, rootIndex }) {
  return new Set(nodes[rootIndex].children.map(index => nodes[index].extraNodeData?.name))
}

/** Return the number of columns of a box that a bot has not received. @returns {number} */
function columnsLacking ({ world }, { low, high }) {
  let lacking = 0
  for (let x = low[0] >> CHUNK_BITS; x <= high[0] >> CHUNK_BITS; x++) {
    for (let z = low[2] >> CHUNK_BITS; z <= high[2] >> CHUNK_BITS; z++) {
      if (!world.getColumn(x, z)) lacking += 1
    }
  }
  return lacking
}

module.exports = { Operator }
