'use strict'
/**
 * Allotment of the one world to regions: chunk-aligned strips along x, far apart from one another. Returned strips are
 * used again.
 */
const CHUNK = 16
// Farther than any client loads chunks or any server plugin looks.
const GAP_CHUNKS = 64
// The world of Minecraft ends at 30 million blocks.
const LAST_CHUNK = 1800000

class Allotment {
  constructor () {
    this.taken = []
  }

  /**
   * Reserve a strip for a region.
   * @param {import('./box').Box} box box in scenario coordinates
   * @returns {{x: number, z: number}} server position of scenario (0, y, 0); multiples of 16
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
