'use strict'
/** A place on a server elsewhere: its ticks are those of the server's age. */
const { Place } = require('../regions/place')

class RemotePlace extends Place {
  /**
   * @param {object} options of Place
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

  /** Count on from a tick, from now. */
  rebase (tick) {
    this.tick = tick
    this.start = this.clock.age - tick
  }

  /** @returns {number} the tick that the server is in */
  now () {
    return Math.max(this.tick, this.clock.age - this.start)
  }
}

module.exports = { RemotePlace }
