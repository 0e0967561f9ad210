'use strict'

const TICK_MS = 50

/** Resolve after a number of ticks of real time (50 ms each); never once the signal is aborted. */
function byTimer (number, signal) {
  return new Promise(resolve => {
    const timer = setTimeout(resolve, number * TICK_MS)
    signal?.addEventListener('abort', () => clearTimeout(timer))
  })
}

/** Resolve after a number of ticks of the world's time. */
function ticks ({ wait }, number) {
  return wait(number)
}

/** Check a condition every tick. @returns {Promise<boolean>} true if it held within `limit` ticks */
async function until ({ wait }, condition, limit) {
  for (let passed = 0; !condition(); passed++) {
    if (passed >= limit) return false
    await wait(1)
  }
  return true
}

/**
 * Return a function that runs actions one after the other. An action that has to wait for another one starts in a new
 * tick; an action that does not have to wait starts at once.
 * @param {(number: number) => Promise<void>} wait resolves after a number of ticks
 * @returns {(action: () => any) => Promise<any>}
 */
function turns (wait) {
  let last = null
  return async action => {
    const before = last
    const mine = Promise.withResolvers()
    last = mine.promise
    try {
      if (before !== null) {
        await before
        await wait(1)
      }
      return await action()
    } finally {
      if (last === mine.promise) last = null
      mine.resolve()
    }
  }
}

module.exports = { byTimer, ticks, turns, until }
