'use strict'
/**
 * Virtual time. Every region has a `Context`: its own time, timers and random numbers. The `Clock` knows which context
 * is active; code that uses time and timers affects only this context. Time moves only inside `advance`.
 */
const { Random } = require('./random')
const { TimerQueue } = require('./timers')

// Start of every context's Date, so that no real date can enter a run.
const EPOCH_MS = Date.UTC(2024, 0, 1)
// Largest number of consecutive immediates at one instant, after which time moves on.
const MAX_IMMEDIATES = 100000

const realSetImmediate = setImmediate

class Context {
  /**
   * @param {string} seed seed of this context's random numbers
   * @param {(error: Error, owner: ?string) => void} [report] called with an error of a timer's callback, and the
   *   timer's owner; without it `advance` throws the error, and the timers due after it wait
   */
  constructor (seed, report = rethrow) {
    this.report = report
    this.time = 0
    this.charged = 0
    this.shift = 0
    // Owner of the running code. Timers that it starts before its first await belong to the same owner.
    this.owner = null
    this.random = new Random(seed)
    this.timers = new TimerQueue(() => this.time)
  }

  /** Return the milliseconds since the context began, including the thinking time charged to this callback. */
  now () {
    return this.time + this.charged
  }

  /** Set the context's date to `ms` after its beginning; it may go back. Waiting timers are not affected. */
  setDate (ms) {
    this.shift = ms - this.time
  }

  /** Run `action` as code of an owner, and report its error. */
  run (owner, action) {
    this.owner = owner
    try {
      action()
    } catch (error) {
      this.report(error, owner)
    } finally {
      this.owner = null
    }
  }
}

class Clock {
  /**
   * @param {string} seed seed of the root context, which is active while no region is
   */
  constructor (seed) {
    this.root = new Context(seed)
    this.active = this.root
  }

  /** Return the milliseconds since 1970 in the active context. */
  epochNow () {
    return EPOCH_MS + this.active.now() + this.active.shift
  }

  /**
   * Charge thinking time to the running code: the active context's clock reads `ms` later until its current callback
   * ends. Without the charge a search that is bounded by time would never end.
   */
  charge (ms) {
    this.active.charged += ms
  }

  /** Run `action` with `context` active, and then its immediate consequences. Calls must not overlap. */
  async within (context, action) {
    if (this.active !== this.root) throw new Error('a region is already running')
    this.active = context
    try {
      const result = await action()
      await drain()
      return result
    } finally {
      context.charged = 0
      this.active = this.root
    }
  }

  /** Advance the active context's time, firing its timers in order. */
  async advance (ms) {
    const context = this.active
    const end = context.time + ms
    let immediates = 0
    await drain()
    for (;;) {
      const timer = context.timers.peek()
      if (timer === undefined || timer.due > end || immediates > MAX_IMMEDIATES) break
      immediates = timer.due > context.time ? 0 : immediates + 1
      context.time = Math.max(context.time, timer.due)
      context.charged = 0
      fire(context, timer)
      await drain()
    }
    context.charged = 0
    context.time = end
  }
}

function fire (context, timer) {
  context.timers.pop()
  timer.active = false
  if (timer.repeat) context.timers.schedule(timer)
  context.run(timer.owner, () => timer.callback(...timer.args))
}

function rethrow (error) {
  throw error
}

/** Resolve when all microtasks and process.nextTick callbacks have run. */
function drain () {
  return new Promise(resolve => { realSetImmediate(resolve) })
}

module.exports = { Clock, Context, EPOCH_MS }
