'use strict'
/**
 * Block states of a box, in chunks; equal chunks are stored once, so that a large box takes as much memory as what it
 * contains. A small box is one chunk. Python decides how a box is cut, and tells it in each message.
 */
const { BadRequest } = require('../channel/errors')
const { CHUNK } = require('./allotment')
const { expanded, runsOf, statesOf } = require('./box')

// A shift by so many bits turns all indices of a box that is one chunk into chunk 0.
const ONE_CHUNK = 30

class Terrain {
  /**
   * @param {import('./box').Box} box
   * @param {object} cut
   * @param {[number, number, number]} cut.first position of the first cell of the first chunk
   * @param {number} cut.shift binary logarithm of a chunk's edge; `ONE_CHUNK` for one chunk
   * @param {[number, number, number]} cut.sizes cells of a chunk along x, y, z
   * @param {[number, number, number]} cut.counts chunks along x, y, z
   * @param {Int32Array} rows by place of a chunk (z fastest), its number in `chunks`
   * @param {Int32Array[]} chunks states of the chunks, z fastest; cells outside the box have no meaning
   */
  constructor (box, { first, shift, sizes, counts }, rows, chunks) {
    this.box = box
    this.first = first
    this.shift = shift
    this.mask = (1 << shift) - 1
    this.sizes = sizes
    this.counts = counts
    this.rows = rows
    this.chunks = chunks
    // Number of cells of a chunk.
    this.volume = sizes[0] * sizes[1] * sizes[2]
    // Numbers of the chunks that only one place uses since a change there.
    this.own = new Set()
  }

  /**
   * Return the terrain in a message.
   * @param {Uint8Array | object} blocks BLOCKS of the channel
   * @param {import('./box').Box} box
   * @throws {BadRequest} if it does not fill the box
   */
  static read (blocks, box) {
    if (ArrayBuffer.isView(blocks)) return Terrain.of(statesOf(blocks, box), box)
    const { first, side, counts, rows: rowRuns, states } = blocks
    const volume = side ** 3
    const isCut = CHUNK % side === 0 && [0, 1, 2].every(axis => first[axis] <= box.low[axis] && first[axis] + counts[axis] * side > box.high[axis])
    const rows = expanded(rowRuns, counts[0] * counts[1] * counts[2])
    const count = rows === null ? 0 : rows.reduce((most, row) => Math.max(most, row), 0) + 1
    const cells = count > rows?.length ? null : expanded(states, count * volume)
    if (!isCut || rows === null || cells === null || rows.some(row => row < 0)) {
      throw new BadRequest(`the chunks of the blocks do not fill the box from (${box.low.join(', ')}) to (${box.high.join(', ')})`)
    }
    const chunks = Array.from({ length: count }, (_, row) => cells.subarray(row * volume, (row + 1) * volume))
    return new Terrain(box, { first, shift: Math.log2(side), sizes: [side, side, side], counts }, rows, chunks)
  }

  /** Return the terrain of a box as one chunk. @param {Int32Array} states states in the box's array order */
  static of (states, box) {
    const terrain = new Terrain(box, { first: box.low, shift: ONE_CHUNK, sizes: box.shape, counts: [1, 1, 1] }, new Int32Array(1), [states])
    terrain.own.add(0)
    return terrain
  }

  /**
   * Return the terrain as the channel sends it.
   * @returns {Uint8Array | object} BLOCKS of the channel
   */
  message () {
    const { first, sizes: [side], counts, rows, chunks, volume } = this
    if (this.isOne) return runsOf(chunks[0])
    const states = new Int32Array(chunks.length * volume)
    chunks.forEach((chunk, row) => states.set(chunk, row * volume))
    return { first, side, counts, rows: runsOf(rows), states: runsOf(states) }
  }

  /** True if the whole box is one chunk. */
  get isOne () {
    return this.shift === ONE_CHUNK
  }

  /** Return the place of the chunk of a position. @returns {number} */
  place (x, y, z) {
    const { first, shift, counts } = this
    return (((x - first[0]) >> shift) * counts[1] + ((y - first[1]) >> shift)) * counts[2] + ((z - first[2]) >> shift)
  }

  /** Return the index of a position in its chunk. @returns {number} */
  within (x, y, z) {
    const { first, mask, sizes } = this
    return (((x - first[0]) & mask) * sizes[1] + ((y - first[1]) & mask)) * sizes[2] + ((z - first[2]) & mask)
  }

  /** Return the state at a position of the box. @returns {number} */
  at (x, y, z) {
    return this.chunks[this.rows[this.place(x, y, z)]][this.within(x, y, z)]
  }

  /** Set the state at a position of the box. */
  set (x, y, z, state) {
    const place = this.place(x, y, z)
    let row = this.rows[place]
    if (!this.own.has(row)) {
      row = this.chunks.push(this.chunks[row].slice()) - 1
      this.own.add(row)
      this.rows[place] = row
    }
    this.chunks[row][this.within(x, y, z)] = state
  }

  /** Return the states of the box in its array order; takes 4 bytes for each of its blocks. @returns {Int32Array} */
  dense () {
    if (this.isOne) return this.chunks[0]
    const states = new Int32Array(this.box.size)
    this.box.forEach((x, y, z, index) => { states[index] = this.at(x, y, z) })
    return states
  }

  /**
   * Call `visit(chunk, from, to)` for each chunk that has a part of a box inside this one, with the corners of the part.
   * @param {import('./box').Box} part
   * @param {(row: number, from: number[], to: number[]) => void} visit
   */
  eachChunk (part, visit) {
    const { first, shift, sizes, counts, rows } = this
    const [from, to] = [part.low, part.high].map(corner => corner.map((value, axis) => (value - first[axis]) >> shift))
    const ends = (axis, number) => {
      const start = first[axis] + number * sizes[axis]
      return [Math.max(part.low[axis], start), Math.min(part.high[axis], start + sizes[axis] - 1)]
    }
    for (let i = from[0]; i <= to[0]; i++) {
      for (let j = from[1]; j <= to[1]; j++) {
        for (let k = from[2]; k <= to[2]; k++) {
          const [x, y, z] = [ends(0, i), ends(1, j), ends(2, k)]
          visit(rows[(i * counts[1] + j) * counts[2] + k], [x[0], y[0], z[0]], [x[1], y[1], z[1]])
        }
      }
    }
  }

  /** Call `visit(x, y, z, state)` for the blocks whose state is one that `wanted` accepts, neither air nor unknown, in no order. */
  find (wanted, visit) {
    const accepted = new Map()
    const isWanted = state => {
      if (state <= 0) return false
      if (!accepted.has(state)) accepted.set(state, wanted(state))
      return accepted.get(state)
    }
    const has = this.chunks.map(states => states.some(isWanted))
    if (!has.includes(true)) return
    this.eachChunk(this.box, (row, from, to) => {
      if (has[row]) this.eachBlock(row, from, to, (x, y, z, state) => { if (isWanted(state)) visit(x, y, z, state) })
    })
  }

  /** Call `visit(x, y, z, state)` for the blocks of a part of a chunk that are not air or unknown. */
  eachBlock (row, from, to, visit) {
    const states = this.chunks[row]
    for (let x = from[0]; x <= to[0]; x++) {
      for (let y = from[1]; y <= to[1]; y++) {
        let index = this.within(x, y, from[2])
        for (let z = from[2]; z <= to[2]; z++) {
          const state = states[index++]
          if (state > 0) visit(x, y, z, state)
        }
      }
    }
  }
}

module.exports = { Terrain }
