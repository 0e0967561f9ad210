'use strict'

const TICK_MS = 50

/** Resolves after a number of ticks of the world's time. */
function ticks (number) {
  return new Promise(resolve => { setTimeout(resolve, number * TICK_MS) })
}

/** Looks at a condition every tick; @returns {Promise<boolean>} whether it held within `limit` ticks */
async function until (condition, limit) {
  for (let passed = 0; !condition(); passed++) {
    if (passed >= limit) return false
    await ticks(1)
  }
  return true
}

module.exports = { ticks, until, TICK_MS }
