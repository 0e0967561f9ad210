'use strict'
/** A place in a server's world, in this process or elsewhere: its box, its tick, who is there, how it is addressed. */
const { Vec3 } = require('vec3')
const { BadRequest } = require('../channel/errors')

class Place {
  /**
   * @param {object} options
   * @param {string} options.name
   * @param {import('./box').Box} options.box
   * @param {{x: number, z: number}} options.origin where scenario (0, y, 0) lies; multiples of 16
   * @param {number} options.tick the tick that has ended
   * @param {string[]} options.known names of the agents that can be spoken of here
   */
  constructor ({ name, box, origin, tick, known }) {
    this.name = name
    this.box = box
    this.origin = origin
    this.tick = tick
    this.known = new Set(known)
    // What was thrown, and in whose bot or connection, if that is known: {error, agent}.
    this.faults = []
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

  /** Run an action as code of an agent's program; what it throws is a fault of that. */
  runAs (agent, action) {
    try {
      action()
    } catch (error) {
      this.faults.push({ error, agent })
    }
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

  /** @throws {Error} the first fault of the server side since the last call */
  raiseFaults () {
    const [fault] = this.faults.splice(0)
    if (fault !== undefined) throw fault.error
  }
}

module.exports = { Place }
