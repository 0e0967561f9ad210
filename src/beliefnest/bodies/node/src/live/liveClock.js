'use strict'
/** Real time behind the interface of the virtual clock (time/clock.js): who lets time pass waits until it has. */
const { setImmediate: pause, setTimeout: sleep } = require('node:timers/promises')
const { TICK_MS } = require('../regions/region')

// Milliseconds that are made up for; what was late by more has been lost.
const MOST_LATE_MS = 2000
// Turns of the event loop in which nothing is under way before all is taken to be done.
const QUIET_TURNS = 3

class LiveClock {
  /** @param {() => boolean} isBusy whether packets are on their way within this process */
  constructor (isBusy) {
    this.isBusy = isBusy
    this.due = performance.now()
    // What a region does with a time of its own; here all have the same.
    this.active = { time: 0 }
  }

  within (_, action) {
    return action()
  }

  /** Resolve when that much more time has passed, and what follows at once has happened. A tick's ends when it is due. */
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
