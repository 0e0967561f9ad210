'use strict'
/**
 * Age of a server's world, in ticks. The server sends it now and then. In between the clock counts on at the server's
 * last speed, but not beyond the next expected message, so that it waits for a slow server. The age never decreases.
 */
const TICK_MS = 50
// A vanilla server sends its age every 20 ticks.
const TELLS_EVERY = 20

class ServerClock {
  /**
   * @param {() => number} now returns milliseconds of this process's own time (time/ownTime.js)
   */
  constructor (now = () => performance.now()) {
    this.now = now
    this.sent = null
    this.sentAt = now()
    // Milliseconds per tick according to the last two messages, but at least the game's own 50.
    this.tickMs = TICK_MS
    this.offset = 0
    // Age and offset before the server sent a lower age; null if it sent none.
    this.before = null
    this.latest = 0
    this.seen = 0
  }

  /**
   * Set the age that the server sent. If it has decreased, count on from here: the server was set up anew. But some
   * servers send age 0 to a player who joins, and then the true one: if the next age is not below the one before, the
   * lower one is ignored.
   */
  tell (age) {
    if (this.sent !== null && age < this.sent) {
      this.before ??= { sent: this.sent, offset: this.offset }
      this.offset = this.latest - age
    } else if (age > this.sent) {
      if (age >= this.before?.sent) this.offset = this.before.offset
      this.before = null
    }
    if (this.sent !== null && age > this.sent) this.tickMs = Math.max(TICK_MS, this.silence / (age - this.sent))
    this.sent = age
    this.sentAt = this.now()
  }

  /** Return true if the server has ever sent its age. */
  get isSet () {
    return this.sent !== null
  }

  /** Return the milliseconds since the server last sent its age. */
  get silence () {
    return this.now() - this.sentAt
  }

  get age () {
    this.look()
    return this.latest
  }

  /**
   * Return the number of ticks that this process has followed. Ticks that pass between two looks at the clock count as
   * one. Limits are counted in these ticks, because a process without a processor sees neither the ticks that pass nor
   * the answers that arrive in them.
   */
  get followed () {
    this.look()
    return this.seen
  }

  look () {
    if (this.sent === null) return
    const passed = Math.min(Math.floor(this.silence / this.tickMs), TELLS_EVERY - 1)
    const age = this.sent + this.offset + passed
    if (age <= this.latest) return
    this.latest = age
    this.seen += 1
  }
}

module.exports = { ServerClock, TICK_MS }
