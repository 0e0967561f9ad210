'use strict'
/**
 * Own time of a process in real time: the time in which its event loop ran. It stands still while the process waits
 * for a processor or computes, so that no limit runs out before the process has read what has arrived.
 */
const perfHooks = require('node:perf_hooks')
const timersPromises = require('node:timers/promises')
const { realNow } = require('./install')

// Interval, in milliseconds, of looks at the time; an event loop that is not held up takes a turn at least as often.
const PULSE_MS = 50
// Largest number of milliseconds that counts between two looks.
const MOST_MS = 2 * PULSE_MS

class OwnTime {
  /**
   * @param {() => number} realNow returns the milliseconds of real time
   */
  constructor (realNow) {
    this.realNow = realNow
    this.looked = realNow()
    this.passed = 0
  }

  /** Return the milliseconds of own time. It is exact if it is asked for once in `PULSE_MS` at least. */
  now () {
    const real = this.realNow()
    this.passed += Math.min(real - this.looked, MOST_MS)
    this.looked = real
    return this.passed
  }

  /**
   * Return `setTimeout` and `clearTimeout` whose delays are of own time.
   * @param {{setTimeout: function, clearTimeout: function}} real functions whose delays are of real time
   */
  timers (real) {
    const setTimeout = (callback, delay, ...args) => {
      const due = this.now() + (delay >= 1 ? delay : 1)
      const fire = () => {
        const left = due - this.now()
        if (left > 0) timer.rest = real.setTimeout(fire, left)
        else callback(...args)
      }
      const timer = real.setTimeout(fire, delay)
      return timer
    }
    const clearTimeout = timer => {
      real.clearTimeout(timer?.rest)
      real.clearTimeout(timer)
    }
    return { setTimeout, clearTimeout }
  }
}

/**
 * Let `performance.now` and all timeouts of this process follow its own time. It must be installed before any other
 * module is loaded, because modules keep the functions that they find when they load.
 */
function installOwnTime () {
  const time = new OwnTime(realNow)
  setInterval(() => time.now(), PULSE_MS).unref()
  const functions = time.timers({ setTimeout, clearTimeout })
  Object.assign(globalThis, functions)
  Object.defineProperty(perfHooks.performance, 'now', { value: () => time.now(), configurable: true })
  const { setTimeout: real } = timersPromises
  // A wait with options, such as a signal that ends it, stays in real time: nothing in this process makes one.
  timersPromises.setTimeout = (delay, value, options) => options === undefined
    ? new Promise(resolve => functions.setTimeout(resolve, delay, value))
    : real(delay, value, options)
}

module.exports = { installOwnTime, OwnTime }
