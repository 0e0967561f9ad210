'use strict'
/** Isolated part of the embedded world, with its own time, random numbers and state. */
const { Context } = require('../time/clock')
const { Mail } = require('../net/transport')
const { Random } = require('../time/random')
const { Translator } = require('../net/translate')
const { regionalState } = require('../server/regional')
const { columnsOf } = require('./ground')
const { Place } = require('./place')

const TICK_MS = 50

class Region extends Place {
  /**
   * @param {object} options
   * @param {string} options.name
   * @param {string} options.seed seed of its random numbers
   * @param {import('./box').Box} options.box
   * @param {{x: number, z: number}} options.origin origin from the allotment
   * @param {number} options.tick last tick that has ended
   * @param {string[]} options.agentNames names of the agents that may be mentioned here
   */
  constructor ({ name, seed, box, origin, tick, agentNames }) {
    super({ name, box, origin, tick, agentNames })
    this.seed = seed
    this.state = regionalState()
    this.columns = columnsOf(box, origin)
    // Blocks at the beginning; null until they are told.
    this.ground = null
    // Positions (server) in the box whose block changed since the last SNAPSHOT, by text.
    this.changed = new Map()
    const report = (error, agent) => this.faults.push({ error, agent })
    this.context = new Context(seed, report)
    this.context.time = tick * TICK_MS
    this.mail = new Mail((agent, action) => this.context.run(agent, action), report)
    this.translator = new Translator(origin)
  }

  /** Return the spawn point that bots are told (server): always the lowest corner of the box. */
  get spawnPoint () {
    return this.toServer(this.box.low)
  }

  /** Record that the block at a position (server) has changed. */
  noteChange (position) {
    if (this.contains(position)) this.changed.set(`${position.x},${position.y},${position.z}`, position)
  }

  /**
   * Return the blocks that changed since the last call, as [x, y, z, state].
   * @param {(position: import('vec3').Vec3) => number} stateAt returns the state at a position (server)
   */
  takeChanges (stateAt) {
    const changes = Array.from(this.changed.values(), position => [...this.toScenario(position), stateAt(position)])
    this.changed.clear()
    return changes
  }

  runAs (agent, action) {
    this.context.run(agent, action)
  }

  /** Reset the random numbers, so that they depend only on seed and tick and not on earlier draws. */
  reseed () {
    this.context.random = new Random(`${this.seed} ${this.tick}`)
  }
}

module.exports = { Region, TICK_MS }
