'use strict'
/** One isolated place of the world: its box, its time, its players, and how it is addressed. */
const { Vec3 } = require('vec3')
const { Context } = require('../time/clock')
const { Mail } = require('../net/transport')
const { BadRequest } = require('../channel/errors')
const { Random } = require('../time/random')
const { Translator } = require('../net/translate')
const { regionalState } = require('../server/regional')
const { columnsOf } = require('./columns')

const TICK_MS = 50

class Region {
  /**
   * @param {object} options
   * @param {string} options.name
   * @param {string} options.seed of its random numbers
   * @param {import('./box').Box} options.box
   * @param {{x: number, z: number}} options.origin from the allotment
   * @param {number} options.tick the tick that has ended
   * @param {string[]} options.known names of the agents that can be spoken of here
   */
  constructor ({ name, seed, box, origin, tick, known }) {
    this.name = name
    this.seed = seed
    this.box = box
    this.origin = origin
    this.tick = tick
    this.known = new Set(known)
    this.state = regionalState()
    this.columns = columnsOf(box, origin)
    // What was thrown, and in whose bot or connection, if that is known: {error, agent}.
    this.faults = []
    const report = (error, agent) => this.faults.push({ error, agent })
    this.context = new Context(seed, report)
    this.context.time = tick * TICK_MS
    this.mail = new Mail((agent, action) => this.context.run(agent, action), report)
    this.translator = new Translator(origin)
    this.bodies = new Map()
    this.recorder = null
  }

  /**
   * @returns {{bot: object, player: object}} of an agent
   * @throws {BadRequest} if it is not here
   */
  body (agent) {
    const body = this.bodies.get(agent)
    if (body === undefined) {
      throw new BadRequest(`there is no agent ${agent} in region ${this.name}; there are: ${[...this.bodies.keys()].join(', ') || 'none'}`)
    }
    return body
  }

  /** What bots are told as their spawn point: the box's lowest corner, whatever happened (server). */
  get spawnPoint () {
    return this.toServer(this.box.low)
  }

  /**
   * What an agent's skills tell; positions in `detail` are scenario coordinates.
   * @throws {RangeError} for what the server does not let it tell
   */
  report (agent, event) {
    this.body(agent).player.report(event)
  }

  /**
   * An event of this tick; positions in `detail` are scenario coordinates. The kind `claims` is none of its own:
   * it is what the actor's next utterance of `detail.text` claims.
   * @throws {Error} if a claim speaks of what is not here
   */
  emit (event) {
    this.recorder.event(event)
  }

  /** @returns {[number, number, number]} scenario coordinates of a server place */
  toScenario ({ x, y, z }) {
    return [x - this.origin.x, y, z - this.origin.z]
  }

  /** @returns {Vec3} server coordinates of a scenario place */
  toServer ([x, y, z]) {
    return new Vec3(x + this.origin.x, y, z + this.origin.z)
  }

  /** Whether a server place is inside the box. */
  contains ({ x, y, z }) {
    return this.box.contains(
      Math.floor(x) - this.origin.x, Math.floor(y), Math.floor(z) - this.origin.z)
  }

  /** Lets random numbers depend on seed and tick alone, not on what was drawn before. */
  reseed () {
    this.context.random = new Random(`${this.seed} ${this.tick}`)
  }

  /** @throws {Error} the first fault of the server side since the last call */
  raiseFaults () {
    const [fault] = this.faults.splice(0)
    if (fault !== undefined) throw fault.error
  }
}

module.exports = { Region, TICK_MS }
