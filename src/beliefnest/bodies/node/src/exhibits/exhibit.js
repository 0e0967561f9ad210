'use strict'
/**
 * What an embodied simulator holds, as people who visit it are to see it: a place of its own in the server's world. It
 * is no region: nothing happens in it by itself, and nothing that is done there reaches a simulator.
 */
const { Vec3 } = require('vec3')
const { Box, statesOf } = require('../regions/box')
const { keyOf } = require('../server/plugins/lib/positions')

class Exhibit {
  /** @param {object} told EXHIBIT of the channel */
  constructor ({ exhibit: name, origin: [x, z], stand, box: [low, high], blocks, containers, signs, agents }) {
    this.name = name
    this.origin = { x, z }
    this.box = new Box(low, high)
    this.stand = { x: stand[0], y: stand[1], z: stand[2] }
    this.states = statesOf(blocks, this.box)
    this.containers = new Map(containers.map(([x, y, z, items, complete]) => [keyOf({ x, y, z }), { items, complete }]))
    this.signs = new Map(signs.map(([x, y, z, text]) => [keyOf({ x, y, z }), text]))
    this.agents = new Map(Object.entries(agents))
    // Ticks by which a change was told later than it happened, at most.
    this.lag = 0
  }

  /**
   * Take note of what is another than it was.
   * @param {object} changes as `show` of the channel has them
   * @returns {{signs: number[][]}} positions of signs that show another text now
   */
  take ({ blocks, containers, signs, agents }) {
    for (const [x, y, z, state] of blocks) this.states[this.box.index(x, y, z)] = state
    for (const [x, y, z, items, complete] of containers) {
      if (items === null) this.containers.delete(keyOf({ x, y, z }))
      else this.containers.set(keyOf({ x, y, z }), { items, complete })
    }
    const before = this.signs
    this.signs = new Map(signs.map(([x, y, z, text]) => [keyOf({ x, y, z }), text]))
    for (const [label, pose] of Object.entries(agents)) {
      if (pose === null) this.agents.delete(label)
      else this.agents.set(label, pose)
    }
    const keys = new Set([...before.keys(), ...this.signs.keys()].filter(key => before.get(key) !== this.signs.get(key)))
    return { signs: [...keys].map(key => key.split(',').map(Number)) }
  }

  /** @returns {number} the state at a place (exhibit); air outside the box */
  at ({ x, y, z }) {
    return this.box.contains(x, y, z) ? this.states[this.box.index(x, y, z)] : 0
  }

  /** @returns {Vec3} server coordinates of a place */
  toServer ([x, y, z]) {
    return new Vec3(x + this.origin.x, y, z + this.origin.z)
  }

  /** @returns {Vec3} the place of server coordinates */
  toOwn ({ x, y, z }) {
    return new Vec3(x - this.origin.x, y, z - this.origin.z)
  }

  /** Whether somebody who is at server coordinates is there: in the box, or above, below and beside it. */
  holds ({ x, z }, margin) {
    const { low, high } = this.box
    const own = this.toOwn({ x, y: 0, z })
    return own.x >= low[0] - margin && own.x <= high[0] + 1 + margin && own.z >= low[2] - margin && own.z <= high[2] + 1 + margin
  }
}

module.exports = { Exhibit }
