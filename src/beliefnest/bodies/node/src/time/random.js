'use strict'
/** Seeded random numbers: sfc32, seeded by a SHA-256 of a text. */
const { createHash } = require('node:crypto')

class Random {
  /** @param {string} seed any text; the same text gives the same numbers */
  constructor (seed) {
    this.seed = seed
    this.words = null
  }

  /** @returns {number} the next 32 random bits, 0 <= n < 2^32 */
  nextUint32 () {
    const words = (this.words ??= wordsOf(this.seed))
    const sum = (((words[0] + words[1]) | 0) + words[3]) | 0
    words[3] = (words[3] + 1) | 0
    words[0] = words[1] ^ (words[1] >>> 9)
    words[1] = (words[2] + (words[2] << 3)) | 0
    words[2] = (words[2] << 21) | (words[2] >>> 11)
    words[2] = (words[2] + sum) | 0
    return sum >>> 0
  }

  /** @returns {number} 0 <= n < 1 with 53 random bits, as Math.random */
  next () {
    const high = this.nextUint32() >>> 5
    const low = this.nextUint32() >>> 6
    return (high * 67108864 + low) / 9007199254740992
  }

  /** Fills a byte array. */
  fill (bytes) {
    for (let i = 0; i < bytes.length; i++) bytes[i] = this.nextUint32() >>> 24
    return bytes
  }
}

// Most ticks draw no number, so that this waits for the first.
function wordsOf (seed) {
  const digest = createHash('sha256').update(seed).digest()
  return [0, 4, 8, 12].map(offset => digest.readInt32LE(offset))
}

module.exports = { Random }
