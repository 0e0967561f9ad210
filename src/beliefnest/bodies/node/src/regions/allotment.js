'use strict'
/**
 * Where regions lie in the one world: chunk-aligned strips along x, far apart from one
 * another. A strip given back is used again.
 */
const CHUNK = 16
// Farther than any client loads or any server plugin looks.
const GAP_CHUNKS = 64
// Minecraft's world ends at 30 million blocks.
const LAST_CHUNK = 1800000

class Allotment {
  constructor () {
    this.taken = []
  }

  /**
   * @param {import('./box').Box} box in scenario coordinates
   * @returns {{x: number, z: number}} where scenario (0, y, 0) comes to lie; multiples of 16
   */
  take (box) {
    const firstChunk = Math.floor((box.low[0] - 1) / CHUNK)
    const width = Math.floor((box.high[0] + 1) / CHUNK) - firstChunk + 1 + GAP_CHUNKS
    const start = this.freeStart(width)
    if (start + width > LAST_CHUNK) throw new RangeError('the world has no room for another region')
    const strip = { start, width }
    this.taken.push(strip)
    this.taken.sort((a, b) => a.start - b.start)
    return { x: (start - firstChunk) * CHUNK, z: 0, strip }
  }

  giveBack ({ strip }) {
    this.taken.splice(this.taken.indexOf(strip), 1)
  }

  freeStart (width) {
    let start = GAP_CHUNKS
    for (const strip of this.taken) {
      if (start + width <= strip.start) return start
      start = strip.start + strip.width
    }
    return start
  }
}

module.exports = { Allotment, CHUNK }
