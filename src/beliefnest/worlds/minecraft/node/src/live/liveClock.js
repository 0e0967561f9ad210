'use strict'
/**
 * Real time behind the interface of the virtual clock (time/clock.js): code that advances time waits until it has
 * passed.
 */
const { setImmediate: pause, setTimeout: sleep } = require('node:timers/promises')
const { TICK_MS } = require('../regions/region')

// Largest delay, in milliseconds, that is caught up; more is dropped.
const MOST_LATE_MS = 2000
// Idle turns of the event loop after which everything counts as done.
const QUIET_TURNS = 3

class LiveClock {
  /**
   * @param {() => boolean} isBusy returns true while packets are on their way within this process
   */
  constructor (isBusy) {
    this.isBusy = isBusy
    this.due = performance.now()
    // Common time of all contexts; a virtual region has a time of its own.
    this.active = { time: 0 }
  }

  within (_, action) {
    return action()
  }

  /**
   * Resolve when that much more time has passed and its immediate consequences have happened. A tick ends when it is
   * due.
   */
  async advance (ms) {
    if (ms === TICK_MS) await this.tickEnds()
    else if (ms > 0) await sleep(ms)
    await this.settled()
  }

  async tickEnds () {
    this.due = Math.max(this.due + TICK_MS, performance.now() - MOST_LATE_MS)
    for (let left = this.left(); left > 0; left = this.left()) await sleep(left)
  }

  left () {
    return Math.ceil(this.due - performance.now())
  }

  async settled () {
    for (let quiet = 0; quiet < QUIET_TURNS; quiet++) {
      await pause()
      if (this.isBusy()) quiet = 0
    }
  }
}

module.exports = { LiveClock }
