'use strict'
/** Box of blocks: two inclusive corners, dense arrays with x slowest and z fastest. */
const { BadRequest } = require('../channel/errors')

// A run of blocks is a state and a count.
const ROW_BYTES = 2 * Int32Array.BYTES_PER_ELEMENT

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
 * Return block states from the runs of the channel: rows (state, number of consecutive blocks) of int32.
 * @param {Uint8Array} bytes runs of a box
 * @returns {Int32Array} states in the box's array order
 * @throws {BadRequest} if they have not as many blocks as the box
 */
function statesOf (bytes, box) {
  const states = expanded(bytes, box.size)
  if (states !== null) return states
  const runs = rowsOf(bytes)
  let filled = 0
  for (let row = 0; row < runs.length; row += 2) filled += Math.max(runs[row + 1], 0)
  throw new BadRequest(`the box has ${box.size} blocks, so the runs of its blocks must have as many; they have ${filled}`)
}

/** Return the numbers in runs (number, count of consecutive elements with it); null if there are not `size`. */
function expanded (bytes, size) {
  const runs = rowsOf(bytes)
  const numbers = new Int32Array(size)
  let filled = 0
  for (let row = 0; row < runs.length; row += 2) {
    const end = filled + Math.max(runs[row + 1], 0)
    if (runs[row] !== 0) numbers.fill(runs[row], filled, end)
    filled = end
  }
  return filled === size && bytes.byteLength % ROW_BYTES === 0 ? numbers : null
}

function rowsOf (bytes) {
  return new Int32Array(new Uint8Array(bytes).buffer, 0, Math.floor(bytes.byteLength / ROW_BYTES) * 2)
}

/** Return the runs of block states, as the channel sends them. @returns {Uint8Array} */
function runsOf (states) {
  let count = states.length > 0 ? 1 : 0
  for (let index = 1; index < states.length; index++) if (states[index] !== states[index - 1]) count += 1
  const runs = new Int32Array(2 * count)
  for (let first = 0, index = 1, at = 0; index <= states.length; index++) {
    if (index < states.length && states[index] === states[first]) continue
    runs[at++] = states[first]
    runs[at++] = index - first
    first = index
  }
  return new Uint8Array(runs.buffer)
}

module.exports = { Box, expanded, runsOf, statesOf }
