'use strict'
/**
 * Age of a server's world, in ticks. The server sends it now and then. In between the clock counts on at the server's
 * last speed, but not beyond the next expected message, so that it waits for a slow server. The age never decreases.
 */
const TICK_MS = 50
// A vanilla server sends its age every 20 ticks.
const TELLS_EVERY = 20
// Largest time, in milliseconds, that counts between two checks of whether the server is silent.
const MOST_BETWEEN_LOOKS = 1000

class ServerClock {
  /**
   * @param {() => number} now returns milliseconds
   */
  constructor (now = () => performance.now()) {
    this.now = now
    this.told = null
    this.toldAt = now()
    // Milliseconds per tick according to the last two messages, but at least the game's own 50.
    this.tickMs = TICK_MS
    this.offset = 0
    this.latest = 0
    this.waited = 0
    this.lookedAt = now()
  }

  /** Set the age that the server sent. If it has decreased, the server was set up anew; count on from here. */
  tell (age) {
    if (this.told !== null && age < this.told) this.offset = this.latest - age
    if (this.told !== null && age > this.told) this.tickMs = Math.max(TICK_MS, this.silence / (age - this.told))
    this.told = age
    this.toldAt = this.now()
    this.waited = 0
  }

  /** Return true if the server has ever sent its age. */
  get isSet () {
    return this.told !== null
  }

  /** Return the milliseconds since the server last sent its age. */
  get silence () {
    return this.now() - this.toldAt
  }

  /**
   * Return true if the server has been silent for a number of milliseconds, measured by repeated calls. Time in which
   * this process itself was stopped does not count.
   */
  isSilentFor (milliseconds) {
    const now = this.now()
    this.waited += Math.min(now - this.lookedAt, MOST_BETWEEN_LOOKS)
    this.lookedAt = now
    return this.waited > milliseconds
  }

  get age () {
    if (this.told === null) return this.latest
    const passed = Math.min(Math.floor(this.silence / this.tickMs), TELLS_EVERY - 1)
    this.latest = Math.max(this.latest, this.told + this.offset + passed)
    return this.latest
  }
}

module.exports = { ServerClock, TICK_MS }
