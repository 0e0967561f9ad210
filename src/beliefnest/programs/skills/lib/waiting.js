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

/**
 * @returns {(action: () => any) => Promise<any>} runs actions one after the other, each that had to wait in a tick of its
 *   own; who waits for nobody is not held up
 */
function turns () {
  let last = null
  return async action => {
    const before = last
    const mine = Promise.withResolvers()
    last = mine.promise
    try {
      if (before !== null) {
        await before
        await ticks(1)
      }
      return await action()
    } finally {
      if (last === mine.promise) last = null
      mine.resolve()
    }
  }
}

module.exports = { ticks, turns, until, TICK_MS }
