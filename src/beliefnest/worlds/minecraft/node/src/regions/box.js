'use strict'
/** Box of blocks: two inclusive corners, dense arrays with x slowest and z fastest. */
const { BadRequest } = require('../channel/errors')

class Box {
  /**
   * @param {[number, number, number]} low
   * @param {[number, number, number]} high
   */
  constructor (low, high) {
    this.low = low
    this.high = high
    this.shape = [0, 1, 2].map(axis => high[axis] - low[axis] + 1)
    this.size = this.shape[0] * this.shape[1] * this.shape[2]
  }

  contains (x, y, z) {
    const { low, high } = this
    return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1] && z >= low[2] && z <= high[2]
  }

  index (x, y, z) {
    return ((x - this.low[0]) * this.shape[1] + y - this.low[1]) * this.shape[2] + z - this.low[2]
  }

  /** Call `visit(x, y, z, index)` for every position in array order. */
  forEach (visit) {
    let index = 0
    for (let x = this.low[0]; x <= this.high[0]; x++) {
      for (let y = this.low[1]; y <= this.high[1]; y++) {
        for (let z = this.low[2]; z <= this.high[2]; z++) visit(x, y, z, index++)
      }
    }
  }

  /** Return a box that is larger by one block on every side. @returns {Box} */
  grown () {
    return new Box(this.low.map(value => value - 1), this.high.map(value => value + 1))
  }
}

/**
 * Return block states from bytes of the channel.
 * @param {Uint8Array} bytes block states of a box as the channel sends them
 * @returns {Int32Array} states in the box's array order
 * @throws {BadRequest} if their number is not that of the box's blocks
 */
function statesOf (bytes, box) {
  const needed = box.size * Int32Array.BYTES_PER_ELEMENT
  if (bytes.byteLength !== needed) {
    throw new BadRequest(`the box has ${box.size} blocks, so "blocks" must have ${needed} bytes; it has ${bytes.byteLength}`)
  }
  return new Int32Array(new Uint8Array(bytes).buffer)
}

module.exports = { Box, statesOf }
