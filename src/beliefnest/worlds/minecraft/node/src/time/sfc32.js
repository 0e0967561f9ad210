'use strict'
/**
 * Return a generator of random numbers by sfc32. Programs of the scripted world use it, too: the function is handed
 * over to QuickJS as text and must not refer to anything outside it.
 * @param {number[]} words four words of 32 bits, the state of the generator; changed by each draw
 * @returns {{bits: function(): number, fraction: function(): number}} functions for the next 32 bits, 0 <= n < 2^32,
 *   and for the next number 0 <= n < 1 with 53 random bits, as Math.random
 */
module.exports = function sfc32 (words) {
  function bits () {
    const sum = (((words[0] + words[1]) | 0) + words[3]) | 0
    words[3] = (words[3] + 1) | 0
    words[0] = words[1] ^ (words[1] >>> 9)
    words[1] = (words[2] + (words[2] << 3)) | 0
    words[2] = (words[2] << 21) | (words[2] >>> 11)
    words[2] = (words[2] + sum) | 0
    return sum >>> 0
  }

  function fraction () {
    const high = bits() >>> 5
    const low = bits() >>> 6
    return (high * 67108864 + low) / 9007199254740992
  }

  return { bits, fraction }
}
