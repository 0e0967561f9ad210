'use strict'
/** Part of a server's world, in this process or elsewhere: its box, its tick, its agents and its coordinates. */
const { Vec3 } = require('vec3')
const { BadRequest } = require('../channel/errors')

class Place {
  /**
   * @param {object} options
   * @param {string} options.name
   * @param {import('./box').Box} options.box
   * @param {{x: number, z: number}} options.origin server position of scenario (0, y, 0); multiples of 16
   * @param {number} options.tick last tick that has ended
   * @param {string[]} options.agentNames names of the agents that may be mentioned here
   */
  constructor ({ name, box, origin, tick, agentNames }) {
    this.name = name
    this.box = box
    this.origin = origin
    this.tick = tick
    this.agentNames = new Set(agentNames)
    // Errors that were thrown, with the agent in whose bot or connection, if known: {error, agent}.
    this.faults = []
    this.bodies = new Map()
    this.recorder = null
  }

  /**
   * Return bot and player of an agent.
   * @returns {{bot: object, player: object}}
   * @throws {BadRequest} if there is no such agent
   */
  body (agent) {
    const body = this.bodies.get(agent)
    if (body === undefined) {
      throw new BadRequest(`there is no agent ${agent} in region ${this.name}; there are: ${[...this.bodies.keys()].join(', ') || 'none'}`)
    }
    return body
  }

  /** Run an action as code of an agent's program; an error that it throws is a fault of that program. */
  runAs (agent, action) {
    try {
      action()
    } catch (error) {
      this.faults.push({ error, agent })
    }
  }

  /**
   * Report an event of an agent's skills; positions in `detail` are scenario coordinates.
   * @throws {RangeError} if the server does not allow the event
   */
  report (agent, event) {
    this.body(agent).player.report(event)
  }

  /**
   * Record an event of this tick; positions in `detail` are scenario coordinates. The kind `claims` is not an event
   * itself: it announces the claims of the actor's next utterance of `detail.text`.
   * @throws {Error} if a claim mentions something that does not exist here
   */
  emit (event) {
    this.recorder.event(event)
  }

  /** Return the scenario coordinates of a server position. @returns {[number, number, number]} */
  toScenario ({ x, y, z }) {
    return [x - this.origin.x, y, z - this.origin.z]
  }

  /** Return the server coordinates of a scenario position. @returns {Vec3} */
  toServer ([x, y, z]) {
    return new Vec3(x + this.origin.x, y, z + this.origin.z)
  }

  /** Return true if a server position is inside the box. */
  contains ({ x, y, z }) {
    return this.box.contains(
      Math.floor(x) - this.origin.x, Math.floor(y), Math.floor(z) - this.origin.z)
  }

  /** Throw the first fault of the server side since the last call, if there is one. @throws {Error} */
  raiseFaults () {
    const [fault] = this.faults.splice(0)
    if (fault !== undefined) throw fault.error
  }
}

module.exports = { Place }
