'use strict'
/**
 * World of the blocks that an agent knows, with the interface of a bot's `world`; unknown blocks are null. Outside the
 * box there are only walls and air, which never change, and the bot's own world answers for them.
 */
const { Vec3 } = require('vec3')
const { maker } = require('../blocks')

const UNKNOWN = -1

class KnownWorld {
  /**
   * @param {object} options
   * @param {import('prismarine-registry').Registry} options.registry
   * @param {import('../regions/box').Box} options.box
   * @param {import('../regions/terrain').Terrain} options.states block states; -1 is unknown
   * @param {object} options.beyond the bot's own world
   */
  constructor ({ registry, box, states, beyond }) {
    this.box = box
    this.beyond = beyond
    this.make = maker(registry)
    this.states = states
    // Block objects that were asked for, by place and index in the chunks of `states`.
    this.blocks = new Array(states.rows.length).fill(null)
    this.signs = []
    // Texts of signs by position as a text.
    this.texts = new Map()
    // The raycast function follows rays through this world's `getBlock`.
    this.raycast = beyond.raycast
  }

  /** Return true if the block at a position is unknown. */
  lacks (x, y, z) {
    return this.box.contains(x, y, z) && this.states.at(x, y, z) < 0
  }

  /** Return the block at integer coordinates. @returns {?object} */
  blockIn (x, y, z) {
    if (!this.box.contains(x, y, z)) return this.beyond.getBlock(new Vec3(x, y, z))
    const { states } = this
    const [place, index] = [states.place(x, y, z), states.within(x, y, z)]
    const block = this.blocks[place]?.[index] ?? null
    if (block !== null) return block
    const state = states.chunks[states.rows[place]][index]
    if (state < 0) return null
    const blocks = (this.blocks[place] ??= new Array(states.volume).fill(null))
    return (blocks[index] = this.made(state, x, y, z))
  }

  /** Make the block object at a position anew when it is next asked for. */
  forget (x, y, z) {
    const blocks = this.blocks[this.states.place(x, y, z)]
    if (blocks !== null) blocks[this.states.within(x, y, z)] = null
  }

  getBlock ({ x, y, z }) {
    return this.blockIn(Math.floor(x), Math.floor(y), Math.floor(z))
  }

  /** Return a block of a state at a position. */
  made (state, x, y, z) {
    const block = this.make(state)
    block.position = new Vec3(x, y, z)
    const text = this.texts.size === 0 ? undefined : this.texts.get(`${x},${y},${z}`)
    // Add the methods that the game's blocks have for signs.
    return text === undefined ? block : Object.assign(block, { entity: {}, getSignText: () => [text, ''] })
  }

  /** Set the texts of all signs, as [x, y, z, text]. */
  readSigns (signs) {
    for (const [x, y, z] of [...this.signs, ...signs]) this.forget(x, y, z)
    this.signs = signs
    this.texts = new Map(signs.map(([x, y, z, text]) => [`${x},${y},${z}`, text]))
  }

  /**
   * Set the state at a position; -1 for unknown.
   * @returns {{before: ?object, after: ?object}} blocks
   */
  learn (x, y, z, state) {
    const before = this.blockIn(x, y, z)
    this.states.set(x, y, z, state)
    this.forget(x, y, z)
    return { before, after: this.blockIn(x, y, z) }
  }

  /** Return the positions of known blocks that match, nearest first. @returns {Vec3[]} */
  find (matches, point, maxDistance, count) {
    const { low, high } = this.box
    const reach = (axis, coordinate) => [Math.max(low[axis], Math.floor(coordinate - maxDistance)), Math.min(high[axis], Math.ceil(coordinate + maxDistance))]
    const [[x0, x1], [y0, y1], [z0, z1]] = [reach(0, point.x), reach(1, point.y), reach(2, point.z)]
    const places = []
    for (let x = x0; x <= x1; x++) {
      for (let y = y0; y <= y1; y++) {
        for (let z = z0; z <= z1; z++) {
          const block = this.blockIn(x, y, z)
          if (block !== null && matches(block) && block.position.distanceTo(point) <= maxDistance) places.push(block.position.clone())
        }
      }
    }
    return places.sort((a, b) => a.distanceTo(point) - b.distanceTo(point)).slice(0, count)
  }
}

module.exports = { KnownWorld, UNKNOWN }
