'use strict'
/** Seeded random numbers: sfc32, seeded by a SHA-256 of a text. */
const { createHash } = require('node:crypto')
const sfc32 = require('./sfc32')

class Random {
  /**
   * @param {string} seed any text; the same text gives the same numbers
   */
  constructor (seed) {
    this.seed = seed
    this.drawn = null
  }

  /** Return the next 32 random bits, 0 <= n < 2^32. @returns {number} */
  nextUint32 () {
    this.drawn ??= sfc32(wordsOf(this.seed))
    return this.drawn.bits()
  }

  /** Return the next number 0 <= n < 1 with 53 random bits, as Math.random. @returns {number} */
  next () {
    this.drawn ??= sfc32(wordsOf(this.seed))
    return this.drawn.fraction()
  }

  /** Fill a byte array. */
  fill (bytes) {
    for (let i = 0; i < bytes.length; i++) bytes[i] = this.nextUint32() >>> 24
    return bytes
  }
}

// Seed on the first draw, because most ticks draw no number.
function wordsOf (seed) {
  const digest = createHash('sha256').update(seed).digest()
  return [0, 4, 8, 12].map(offset => digest.readInt32LE(offset))
}

module.exports = { Random }
