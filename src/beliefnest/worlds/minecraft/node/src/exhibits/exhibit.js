'use strict'
/**
 * View of a simulator's content for visitors: an area of its own in the server's world. It is not a region: nothing
 * happens in it by itself, and no act in it reaches a simulator.
 */
const { Vec3 } = require('vec3')
const { Box } = require('../regions/box')
const { Terrain } = require('../regions/terrain')
const { keyOf } = require('../server/plugins/lib/positions')

class Exhibit {
  /**
   * @param {object} description EXHIBIT of the channel
   */
  constructor ({ exhibit: name, origin: [x, z], stand, box: [low, high], blocks, containers, signs, agents }) {
    this.name = name
    this.origin = { x, z }
    this.box = new Box(low, high)
    this.stand = { x: stand[0], y: stand[1], z: stand[2] }
    this.blocks = Terrain.read(blocks, this.box)
    this.containers = new Map(containers.map(([x, y, z, items, complete]) => [keyOf({ x, y, z }), { items, complete }]))
    this.signs = new Map(signs.map(([x, y, z, text]) => [keyOf({ x, y, z }), text]))
    this.agents = new Map(Object.entries(agents))
    // Largest delay, in ticks, between a change and its message.
    this.lag = 0
  }

  /**
   * Apply the changes of a `show` message.
   * @param {object} changes changed parts, as in the channel's `show`
   * @returns {{signs: number[][]}} positions of signs whose text has changed
   */
  take ({ blocks, containers, signs, agents }) {
    for (const [x, y, z, state] of blocks) this.blocks.set(x, y, z, state)
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

  /** Return the state at a position of the exhibit; air outside the box. @returns {number} */
  at ({ x, y, z }) {
    return this.box.contains(x, y, z) ? this.blocks.at(x, y, z) : 0
  }

  /** Return the server coordinates of a position. @returns {Vec3} */
  toServer ([x, y, z]) {
    return new Vec3(x + this.origin.x, y, z + this.origin.z)
  }

  /** Return the position of server coordinates. @returns {Vec3} */
  toOwn ({ x, y, z }) {
    return new Vec3(x - this.origin.x, y, z - this.origin.z)
  }

  /** Return true if server coordinates belong to the exhibit: in the box, or above, below or near it. */
  holds ({ x, z }, margin) {
    const { low, high } = this.box
    const own = this.toOwn({ x, y: 0, z })
    return own.x >= low[0] - margin && own.x <= high[0] + 1 + margin && own.z >= low[2] - margin && own.z <= high[2] + 1 + margin
  }
}

module.exports = { Exhibit }
