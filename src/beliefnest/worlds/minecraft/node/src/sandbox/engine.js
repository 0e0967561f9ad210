'use strict'
/**
 * Guests: QuickJS interpreters, one WebAssembly instance with fresh memory per program, so that nothing of a program
 * outlives it, not even a damaged interpreter. Execution is metered (meter.js), so that a program ends by its own
 * amount of computation and not by a clock.
 */

const { QuickJS, GuestException } = require('./quickjs')
const { readyMade } = require('./beginning')
const { STACK_BYTES, interpreterBytes } = require('./interpreter')
const { Memories } = require('./memories')
const { guestSource } = require('./guest/source')
const { kindNames, tables } = require('./policy/kinds')
const { GOAL_NAMES } = require('./constructions')
const { parsed, tooMuch } = require('./text')

const SHADOW_STACK_BYTES = 400_000
const UNMETERED = 0x7fffffff
// Fuel reserved for loops that never poll for interrupts. A poll ends the guest politely when only this reserve is
// left; without a poll the guest traps when the reserve is used up.
const GRACE = 20_000_000
const CROSSING_STACK_BYTES = 20_000
// Fuel of a guest that ended while it called the host: enough to return from that call, after which it traps.
const LAST_BREATH = 20_000
const JOBS_AT_ONCE = 100
const MOST_STRAYS = 1000
// Fuel for waking a guest: about as much as for answering it.
const WAKE_COST = 1500
const HOST_FUNCTIONS = { host: 1, now: 2, random: 3 }

/** Reason why a guest can run no more: `fuel`, `memory`, `stack`, `internal`, or the kind given to `end`. */
class GuestEnded extends Error {
  /**
   * @param {string} kind
   * @param {string} detail
   * @param {string} [stack] the guest's stack at that moment
   */
  constructor (kind, detail, stack = '') {
    super(detail)
    this.name = 'GuestEnded'
    this.kind = kind
    this.guestStack = stack
  }
}

/**
 * @typedef {{parameters: string[], skills: string[], data: boolean}} Scope names in scope of a program: all of them in
 *   order, those that are skills, and whether `mcData` is among them
 */

/** Compiled interpreter, which makes guests. */
class Engine {
  /**
   * @param {() => void} [alive] called now and then while a guest computes within its limits
   */
  constructor (alive = () => {}) {
    this.alive = alive
    this.module = new WebAssembly.Module(interpreterBytes())
    this.templates = new Map()
    this.last = null
    this.ready = null
    this.memories = new Memories()
  }

  /**
   * Return a guest for a program.
   * @param {{fuel: number, memory: number}} limits fuel in units of the meter, memory in bytes
   * @param {Scope} scope
   * @returns {Promise<Guest>} settled without any timer or input
   */
  async open (limits, scope) {
    const { ready } = this
    const key = JSON.stringify([limits, scope])
    this.last = { key, limits, scope }
    this.ready = null
    if (ready?.key === key) return ready.guest
    if (ready !== null) this.close(ready.guest)
    return this.make(limits, scope)
  }

  /** Make a guest in advance, for a program with the same limits and scope as the last one. */
  async prepare () {
    if (this.last === null || this.ready !== null) return
    const { key, limits, scope } = this.last
    this.ready = { key, guest: await this.make(limits, scope) }
  }

  async make (limits, scope) {
    const { state, functions } = await this.templateOf(scope)
    const guest = new Guest(limits, functions, this.alive)
    guest.memory = this.memories.take(limits.memory)
    guest.interpreter = await QuickJS.open(this.module, guest.memory, guest)
    guest.interpreter.restore(state)
    guest.interpreter.limitMemory(limits.memory)
    return guest
  }

  /** Take back the memory of a guest that has ended and is not on the stack. The guest must not be used any more. */
  close (guest) {
    this.memories.give(guest.memory, guest.limits.memory)
  }

  /**
   * Return the initial state of all programs of a scope; it is read or made on first use.
   * @param {Scope} scope
   */
  templateOf (scope) {
    const text = JSON.stringify(scope)
    if (!this.templates.has(text)) this.templates.set(text, this.template(text))
    return this.templates.get(text)
  }

  async template (scopeText) {
    const template = readyMade()
    return template?.scope === scopeText ? template : this.makeTemplate(scopeText)
  }

  // Make a fresh context, load the guest's side of the border (guest/border.js) and the scope, and save its state.
  async makeTemplate (scopeText) {
    let strays = 0
    const host = { call: () => 0, interrupt: () => false, rejected: () => { strays++ } }
    const interpreter = await QuickJS.open(this.module, this.memories.take(0), host)
    interpreter.create(SHADOW_STACK_BYTES)
    const config = JSON.stringify({ kinds: kindNames, goals: GOAL_NAMES, tables })
    const setUp = interpreter.evaluate(guestSource, 'guest.js')
    const guest = interpreter.call(setUp, [
      ...Object.entries(HOST_FUNCTIONS).map(([name, id]) => interpreter.hostFunction(name, id)), interpreter.string(config)
    ])
    interpreter.call(interpreter.property(guest, 'bind'), [interpreter.string(scopeText)])
    const functions = Object.fromEntries(['start', 'dispatch', 'describe'].map((name) => [name, interpreter.property(guest, name)]))
    interpreter.evaluate('Promise.reject()', 'check.js')
    if (strays !== 1) throw new Error('this build of QuickJS has its rejection tracker at another place than rejections.js assumes; correct PLACE there')
    return { state: interpreter.save(), functions }
  }
}

/** Interpreter of one program. After its end every call throws GuestEnded. */
class Guest {
  constructor (limits, functions, alive) {
    this.limits = limits
    this.alive = alive
    this.functions = functions
    this.interpreter = null
    this.memory = null
    this.ended = null
    this.fuelAtEnd = null
    this.marks = { place: 0, length: 0 }
    this.strays = new Map()
    this.nesting = 0
  }

  /** Return the fuel used so far. */
  get used () {
    return this.limits.fuel + GRACE - this.interpreter.fuel.value
  }

  /** Return true if the guest's memory has grown to its limit; it never shrinks. */
  get isFull () {
    return this.interpreter.glue.HEAPU8.length >= this.limits.memory
  }

  /** Return true if no code of the guest is on the stack. */
  get idle () {
    return this.nesting === 0
  }

  /**
   * Start the program.
   * @param {{text: string, marks: number}} program `text` of a function of (marks, ...parameters) that returns a promise
   * @param {{host: function(string): string, now: function(): number, random: function(): number}} world
   */
  start (program, { host, now, random }) {
    const { interpreter } = this
    interpreter.fuel.value = UNMETERED
    const { place, value } = interpreter.buffer(program.marks * 4)
    this.marks = { place, length: program.marks }
    this.answers = {
      [HOST_FUNCTIONS.host]: (values) => interpreter.string(host(interpreter.argument(values, 0))),
      [HOST_FUNCTIONS.now]: () => interpreter.number(now()),
      [HOST_FUNCTIONS.random]: () => interpreter.number(random())
    }
    interpreter.fuel.value = this.limits.fuel + GRACE
    this.enter(() => {
      const main = interpreter.evaluate(program.text, 'program.js')
      this.program = interpreter.call(this.functions.start, [main, value])
    })
  }

  /**
   * Return how the program ended. The state is read from the interpreter. The program itself cannot be trusted: it could
   * give a false answer, or replace the functions that answer.
   * @returns {?{ok: boolean, error: object}} null while the program runs
   */
  result () {
    const state = this.interpreter.promiseState(this.program)
    if (state === 'pending') return null
    return state === 'fulfilled' ? { ok: true } : { ok: false, error: this.enter(() => this.reason(this.program)) }
  }

  /**
   * Return the error of the first promise that was rejected without a handler; null if there is none.
   * @returns {?object}
   */
  strayError () {
    const [promise] = this.strays.values()
    return promise === undefined ? null : this.enter(() => this.reason(promise))
  }

  reason (promise) {
    const { interpreter } = this
    try {
      return parsed(interpreter.text(interpreter.call(this.functions.describe, [interpreter.promiseResult(promise)])))
    } catch (error) {
      if (error instanceof GuestException && error.guest.message !== 'interrupted') return {}
      throw error
    }
  }

  /**
   * Send a message to the guest, and run everything that can run.
   * @param {Array} message
   * @param {number} most number of characters that may leave the program; more are its error
   * @returns {{ok: boolean, value: *}}
   */
  send (message, most) {
    const { interpreter } = this
    return this.enter(() => {
      this.charge(WAKE_COST)
      const text = interpreter.string(JSON.stringify(message))
      const answer = interpreter.call(this.functions.dispatch, [text])
      interpreter.free(text)
      const answerText = interpreter.text(answer)
      interpreter.free(answer)
      return answerText.length > most ? { ok: false, value: { message: tooMuch(most), kind: 'refused' } } : parsed(answerText)
    })
  }

  /**
   * Charge fuel for work that the host does on the program's behalf.
   * @returns {boolean} true if there was enough; a guest without fuel ends when it next runs
   */
  charge (units) {
    if (this.ended) return false
    const { fuel } = this.interpreter
    fuel.value = Math.max(fuel.value - units, GRACE)
    return fuel.value > GRACE
  }

  /** End the guest. Code that is running stops within `LAST_BREATH`. */
  end (kind, detail, stack) {
    if (this.ended) return
    this.fuelAtEnd = this.used
    this.ended = new GuestEnded(kind, detail, stack)
  }

  /** Return the numbers of the executed statements, read from the guest's memory. */
  get statements () {
    const { marked } = this
    const ran = []
    for (let n = 1; n < marked.length; n++) if (marked[n] === n) ran.push(n)
    return ran
  }

  /** Return the number of the statement that began last; 0 for none. */
  get lastStatement () {
    return this.marked[0] ?? 0
  }

  get marked () {
    return new Uint32Array(this.interpreter.glue.HEAPU8.buffer, this.marks.place, this.marks.length)
  }

  /**
   * Call a host function for the interpreter. Charge the stack estimate for the host's frames, which the meter does
   * not count.
   */
  call (id, count, values) {
    if (this.ended) return 0
    const { fuel, depth } = this.interpreter
    const depthBefore = depth.value
    depth.value += CROSSING_STACK_BYTES
    const value = this.answered(id, values)
    depth.value = depthBefore
    if (this.ended) fuel.value = LAST_BREATH
    return value
  }

  // Catch errors of this side: they must not pass through the interpreter's frames.
  answered (id, values) {
    try {
      return this.answers[id](values)
    } catch (error) {
      this.fault(error)
      return 0
    }
  }

  /**
   * Handle the interpreter's report about a promise (a JSValue): it was rejected without a handler, or, if `isHandled`,
   * it has received a handler after that.
   */
  rejected (promise, isHandled) {
    if (this.ended) return
    try {
      const kept = this.strays.get(promise)
      if (!isHandled && this.strays.size < MOST_STRAYS) this.strays.set(promise, this.interpreter.keep(promise))
      if (!isHandled || kept === undefined) return
      this.strays.delete(promise)
      this.interpreter.free(kept)
    } catch (error) {
      this.fault(error)
    }
  }

  /** Return true if the interpreter should stop. The interpreter polls this. */
  interrupt () {
    this.alive()
    return this.interpreter.fuel.value <= GRACE
  }

  enter (act) {
    if (this.ended) throw this.ended
    this.nesting++
    try {
      const result = act()
      if (this.nesting === 1) this.drain()
      return result
    } catch (error) {
      throw this.fault(error)
    } finally {
      this.nesting--
    }
  }

  drain () {
    while (!this.ended && this.interpreter.hasJobs) this.interpreter.runJobs(JOBS_AT_ONCE)
    // A job that was interrupted leaves no error behind.
    if (!this.ended && this.interrupt()) this.end('fuel', 'interrupted')
    if (this.ended) throw this.ended
  }

  fault (error) {
    if (this.ended) return this.ended
    if (!(error instanceof GuestException)) this.end(...this.trapped(error))
    else this.end(...uncaught(error.guest))
    return this.ended
  }

  trapped (error) {
    if (this.interpreter.fuel.value < 0) return ['fuel', 'trap']
    if (this.interpreter.depth.value > STACK_BYTES || error instanceof RangeError) return ['stack', 'trap']
    if (this.isFull) return ['memory', 'trap']
    return ['internal', String(error)]
  }
}

// Return kind, message and stack of an exception that the guest's side of the border did not catch. This happens only
// after the program has damaged that side.
function uncaught ({ name, message, stack }) {
  if (message === 'interrupted') return ['fuel', message, stack]
  if (message === 'out of memory') return ['memory', message, stack]
  if (message === 'stack overflow') return ['stack', message, stack]
  return [name === 'SyntaxError' ? 'syntax' : 'error', `${name}: ${message}`, stack]
}

/** Constants of metering, for other hosts of the same interpreter. */
const METER = {
  shadowStackBytes: SHADOW_STACK_BYTES,
  stackBytes: STACK_BYTES,
  unmetered: UNMETERED,
  grace: GRACE,
  crossingStackBytes: CROSSING_STACK_BYTES,
  lastBreath: LAST_BREATH,
  jobsAtOnce: JOBS_AT_ONCE,
  mostStrays: MOST_STRAYS,
  wakeCost: WAKE_COST
}

module.exports = { Engine, GuestEnded, METER }
