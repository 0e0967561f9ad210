'use strict'
/** Part of a remote server's world. Its ticks follow the server's age. */
const { Place } = require('../regions/place')

class RemotePlace extends Place {
  /**
   * @param {object} options options of Place
   * @param {import('./serverClock').ServerClock} clock
   */
  constructor (options, clock) {
    super(options)
    this.clock = clock
    this.rebase(options.tick)
    // Frames that no call has sent yet.
    this.waiting = []
    this.isDriven = false
    this.pulse = null
  }

  /** Count on from a tick, beginning now. */
  rebase (tick) {
    this.tick = tick
    this.start = this.clock.age - tick
  }

  /** Return the number of ticks that this process has followed, for limits (serverClock.js). @returns {number} */
  get followed () {
    return this.clock.followed
  }

  /** Return the tick of the server's present age. @returns {number} */
  now () {
    return Math.max(this.tick, this.clock.age - this.start)
  }
}

module.exports = { RemotePlace }
