'use strict'
/**
 * Virtual time. Every region has a `Context`: its own time, timers and random numbers.
 * The `Clock` knows which context is active; what code does to time and timers concerns
 * that one alone. Time moves only inside `advance`.
 */
const { Random } = require('./random')
const { TimerQueue } = require('./timers')

// Where every context's Date starts, so that no real date can enter a run.
const EPOCH_MS = Date.UTC(2024, 0, 1)
// Immediates that may follow one another at one instant before time goes on all the same.
const MAX_IMMEDIATES = 100000

const realSetImmediate = setImmediate

class Context {
  /**
   * @param {string} seed of this context's random numbers
   * @param {(error: Error, owner: ?string) => void} [report] hears what a timer's callback throws, and whose
   *   timer it was; without it `advance` throws that, and what was due after it waits
   */
  constructor (seed, report = rethrow) {
    this.report = report
    this.time = 0
    this.charged = 0
    this.shift = 0
    // Whose code runs: what it begins, before it first waits for a promise, is its own as well.
    this.owner = null
    this.random = new Random(seed)
    this.timers = new TimerQueue(() => this.time)
  }

  /** Milliseconds since the context began, thinking time charged to this callback included. */
  now () {
    return this.time + this.charged
  }

  /** Make the context's date, which need not rise, that of `ms` after its beginning; what waits goes on waiting. */
  setDate (ms) {
    this.shift = ms - this.time
  }

  /** Run `action` as code of an owner; what it throws is reported. */
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
  /** @param {string} seed of the root context, which is active whenever no region is */
  constructor (seed) {
    this.root = new Context(seed)
    this.active = this.root
  }

  /** Milliseconds since 1970 in the active context. */
  epochNow () {
    return EPOCH_MS + this.active.now() + this.active.shift
  }

  /**
   * Make running code pay for thinking: the active context's clock reads `ms` later until
   * its current callback ends. Without it a search that is bounded by time never ends.
   */
  charge (ms) {
    this.active.charged += ms
  }

  /**
   * Run `action` with `context` active, then everything it left to do at once.
   * Calls must not overlap.
   */
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

  /** Let the active context's time pass, firing its timers in order. */
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
