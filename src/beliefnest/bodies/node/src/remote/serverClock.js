'use strict'
/**
 * The age of a server's world, in ticks. The server tells it now and then; in between it is counted on, as fast as the
 * server went before, and at most as far as the next telling: a slow server is waited for. It never falls.
 */
const TICK_MS = 50
// Vanilla tells its age every 20 ticks.
const TELLS_EVERY = 20
// Milliseconds that count at most between two looks at whether the server is silent.
const MOST_BETWEEN_LOOKS = 1000

class ServerClock {
  /** @param {() => number} now milliseconds */
  constructor (now = () => performance.now()) {
    this.now = now
    this.told = null
    this.toldAt = now()
    // Milliseconds that a tick takes there, as the two latest tellings say: never less than the game's own.
    this.tickMs = TICK_MS
    this.offset = 0
    this.latest = 0
    this.waited = 0
    this.lookedAt = now()
  }

  /** Take what the server says; one whose age has fallen was set up anew, and is counted on from here. */
  tell (age) {
    if (this.told !== null && age < this.told) this.offset = this.latest - age
    if (this.told !== null && age > this.told) this.tickMs = Math.max(TICK_MS, this.silence / (age - this.told))
    this.told = age
    this.toldAt = this.now()
    this.waited = 0
  }

  /** Whether the server has ever told its age. */
  get isSet () {
    return this.told !== null
  }

  /** Milliseconds since the server told its age. */
  get silence () {
    return this.now() - this.toldAt
  }

  /**
   * Return whether the server has told nothing for so many milliseconds of those who look again and again. Time in which this
   * process itself was stopped is not the server's silence.
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
