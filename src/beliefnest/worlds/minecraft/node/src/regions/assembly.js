'use strict'
/** Assembly of a terrain from its cubes, in any order. Equal cubes are stored once. */
const { BadRequest } = require('../channel/errors')
const { Terrain } = require('./terrain')

const MOST_BYTES = 2 ** 29
const MISSING = -1

class Assembly {
  /**
   * @param {import('./box').Box} box
   * @param {{side: number, margin: number}} cut edge of a cube, a power of 2, and number of cells that the cubes have
   *   before and behind the box on every side
   * @param {number} blank state of cubes that are not put
   */
  constructor (box, { side, margin }, blank) {
    this.box = box
    this.side = side
    this.first = box.low.map(value => value - margin)
    this.counts = box.shape.map(length => Math.ceil((length + 2 * margin) / side))
    this.volume = side ** 3
    this.rows = new Int32Array(this.counts[0] * this.counts[1] * this.counts[2]).fill(MISSING)
    this.chunks = []
    // By hash, the numbers of the cubes that have it.
    this.chunksByHash = new Map()
    this.blank = blank
  }

  /**
   * Set a cube, by its numbers along x, y, z; its states may change afterwards.
   * @throws {BadRequest} if there are too many different cubes
   */
  put ([i, j, k], states) {
    this.rows[(i * this.counts[1] + j) * this.counts[2] + k] = this.rowOf(states)
  }

  /** Return the number of a cube among the different ones. */
  rowOf (states) {
    const { chunks, chunksByHash } = this
    const hash = hashOf(states)
    if (!chunksByHash.has(hash)) chunksByHash.set(hash, [])
    const alike = chunksByHash.get(hash)
    let row = alike.find(each => chunks[each].every((state, index) => state === states[index]))
    if (row === undefined) {
      this.requireRoom(chunks.length)
      alike.push(row = chunks.push(states.slice()) - 1)
    }
    return row
  }

  /** Fail if there is no room for a further cube beside `count` others. @throws {BadRequest} */
  requireRoom (count) {
    const { side, volume } = this
    const most = MOST_BYTES / volume / Int32Array.BYTES_PER_ELEMENT
    if (count >= most) throw new BadRequest(`it holds more than ${most} different cubes of ${side} x ${side} x ${side} blocks, which need ${MOST_BYTES / 2 ** 20} MiB; take a smaller place`)
  }

  /** Return the terrain of the cubes. @returns {Terrain} */
  terrain () {
    if (this.rows.includes(MISSING)) {
      const blank = this.rowOf(new Int32Array(this.volume).fill(this.blank))
      this.rows.forEach((row, place) => { if (row === MISSING) this.rows[place] = blank })
    }
    const { box, first, side, counts, rows, chunks } = this
    return new Terrain(box, { first, shift: Math.log2(side), sizes: [side, side, side], counts }, rows, chunks)
  }
}

/** Return the FNV-1a hash of numbers. */
function hashOf (numbers) {
  let hash = 0x811c9dc5
  for (const number of numbers) hash = Math.imul(hash ^ number, 0x01000193)
  return hash
}

module.exports = { Assembly }
