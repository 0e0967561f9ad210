'use strict'
/**
 * QuickJS, one WebAssembly instance per program: nothing of a program, not even a damaged
 * interpreter, outlives it. What runs is metered (meter.js), so that a program ends by its own
 * amount of computation and not by a clock.
 */

const { QuickJSWASMModule, Lifetime } = require('quickjs-emscripten-core')
const { QuickJSFFI } = require('@jitl/quickjs-wasmfile-release-sync/ffi')
const loadGlue = require('@jitl/quickjs-wasmfile-release-sync/emscripten-module')
const { STACK_BYTES, interpreterBytes } = require('./interpreter')
const { guestSource } = require('./guest/source')

const PAGE = 65536
const INITIAL_PAGES = 256
const SHADOW_STACK_BYTES = 400_000
const UNMETERED = 0x7fffffff
// The part of the limit that only loops without a poll can reach: they trap, polls end politely.
const GRACE = 20_000_000
const CROSSING_STACK_BYTES = 20_000
// After its end a guest that called the host still has to take the answer; then it traps.
const LAST_BREATH = 20_000

/** Why a guest can run no more: `fuel`, `memory`, `stack`, `internal`, or what `end` was told. */
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

/** The compiled interpreter; makes guests. */
class Engine {
  constructor () {
    this.module = new WebAssembly.Module(interpreterBytes())
  }

  /**
   * @param {{fuel: number, memory: number}} limits fuel in units of the meter, memory in bytes
   * @returns {Promise<Guest>} settled without any timer or input
   */
  async open ({ fuel, memory }) {
    const wasmMemory = new WebAssembly.Memory({ initial: INITIAL_PAGES, maximum: INITIAL_PAGES + Math.ceil(memory / PAGE) })
    let instance
    const glue = await loadGlue({
      wasmMemory,
      print: () => {},
      printErr: () => {},
      instantiateWasm: (imports, done) => {
        instance = new WebAssembly.Instance(this.module, imports)
        done(instance)
        return instance.exports
      }
    })
    return new Guest(glue, instance.exports, { fuel, memory })
  }
}

/** One context of one interpreter; after its end every call throws GuestEnded. */
class Guest {
  constructor (glue, { fuel, depth }, limits) {
    this.meters = { fuel, depth }
    this.glue = glue
    this.ffi = new QuickJSFFI(glue)
    this.limits = limits
    this.ended = null
    this.marks = { offset: 0, length: 0 }
    this.nesting = 0
    this.runtime = new QuickJSWASMModule(glue, this.ffi).newRuntime()
    this.runtime.setMemoryLimit(limits.memory)
    this.runtime.setMaxStackSize(SHADOW_STACK_BYTES)
    this.runtime.setInterruptHandler(() => this.meters.fuel.value <= GRACE)
    this.context = this.runtime.newContext()
  }

  /** Units of fuel used so far. */
  get used () {
    return this.limits.fuel + GRACE - this.meters.fuel.value
  }

  /** Whether nothing of the guest is on the stack. */
  get idle () {
    return this.nesting === 0
  }

  /**
   * Prepares the global object.
   * @param {{host: function(string): string, now: function(): number, random: function(): number}} functions
   * @param {object} config plain data for the guest
   * @param {number} marks how many statements can be marked, and one
   */
  prepare ({ host, now, random }, config, marks) {
    const { context } = this
    this.meters.fuel.value = UNMETERED
    const setUp = this.take(context.evalCode(guestSource, 'guest.js'))
    const array = this.take(context.evalCode('(buffer) => new Uint32Array(buffer)', 'guest.js'))
    const guest = this.take(context.callFunction(setUp, context.undefined, [
      context.newFunction('host', (text) => context.newString(this.crossing(() => host(context.getString(text))))),
      context.newFunction('now', () => context.newNumber(now())),
      context.newFunction('random', () => context.newNumber(random())),
      this.take(context.callFunction(array, context.undefined, [this.markBuffer(marks)])),
      context.newString(JSON.stringify(config))
    ]))
    this.dispatch = context.getProp(guest, 'dispatch')
    this.startFunction = context.getProp(guest, 'start')
    this.describeFunction = context.getProp(guest, 'describe')
    this.meters.fuel.value = this.limits.fuel + GRACE
  }

  /**
   * Starts the program.
   * @param {string} text of a function of (marks, ...parameters) that returns a promise
   * @param {string} fileName for the guest's stacks
   */
  start (text, fileName) {
    const { context } = this
    this.enter(() => {
      const program = this.take(context.evalCode(text, fileName))
      this.program = this.take(context.callFunction(this.startFunction, context.undefined, [program]))
    })
  }

  /**
   * Asks the interpreter, not the program, which could lie or break what it would say it with.
   * @returns {?{ok: boolean, error: object}} how the program ended, null while it goes on
   */
  result () {
    const state = this.context.getPromiseState(this.program)
    if (state.type === 'pending') return null
    return state.type === 'fulfilled' ? { ok: true } : { ok: false, error: this.enter(() => this.described(state.error)) }
  }

  described (error) {
    const answer = this.context.callFunction(this.describeFunction, this.context.undefined, [error])
    return answer.error ? {} : JSON.parse(this.context.getString(answer.value))
  }

  /**
   * Hands a message to the guest and lets everything run that can run.
   * @param {Array} message
   * @returns {{ok: boolean, value: *}}
   */
  send (message) {
    const { context } = this
    return this.enter(() => {
      const text = context.newString(JSON.stringify(message))
      const answer = this.take(context.callFunction(this.dispatch, context.undefined, [text]))
      text.dispose()
      const result = JSON.parse(context.getString(answer))
      answer.dispose()
      return result
    })
  }

  /** Takes fuel for work that the host does on the program's behalf. */
  charge (units) {
    this.meters.fuel.value = Math.max(this.meters.fuel.value - units, GRACE)
  }

  /** Ends the guest: what runs of it stops at the next loop turn or call. */
  end (kind, detail, stack) {
    if (this.ended) return
    this.fuelAtEnd = this.used
    this.ended = new GuestEnded(kind, detail, stack)
  }

  /** Numbers of the statements that ran, and the last one, read from the guest's memory. */
  statements () {
    const memory = new Uint32Array(this.glue.HEAPU8.buffer, this.marks.offset, this.marks.length)
    const ran = []
    for (let n = 1; n < memory.length; n++) if (memory[n] === n) ran.push(n)
    return { ran, last: memory.length > 0 ? memory[0] : 0 }
  }

  // An array buffer at a known place, so that it can be read whatever state the guest is in.
  markBuffer (marks) {
    const offset = this.glue._malloc(marks * 4)
    this.marks = { offset, length: marks }
    this.glue.HEAPU8.fill(0, offset, offset + marks * 4)
    const pointer = this.ffi.QTS_NewArrayBuffer(this.context.ctx.value, offset, marks * 4)
    return new Lifetime(pointer, undefined, undefined, this.runtime)
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
    while (!this.ended && this.runtime.hasPendingJob()) {
      const jobs = this.runtime.executePendingJobs(100)
      if (jobs.error) this.take(jobs)
    }
    if (this.ended) throw this.ended
    // A job that was interrupted leaves no error behind.
    if (this.meters.fuel.value <= GRACE) this.end('fuel', 'interrupted')
    if (this.ended) throw this.ended
  }

  // The estimate of the stack counts no frames of the host between two of the guest.
  crossing (act) {
    if (this.ended) return ''
    const { fuel, depth } = this.meters
    const depthBefore = depth.value
    depth.value += CROSSING_STACK_BYTES
    const result = act()
    depth.value = depthBefore
    if (this.ended) fuel.value = LAST_BREATH
    return this.ended ? '' : result
  }

  take (result) {
    if (!result.error) return result.value
    const { name, message, stack } = this.describe(result.error)
    throw Object.assign(new Error(message), { guest: { name, message, stack } })
  }

  describe (handle) {
    const text = (key) => {
      const property = this.context.getProp(handle, key)
      return this.context.typeof(property) === 'string' ? this.context.getString(property) : ''
    }
    return { name: text('name'), message: text('message'), stack: text('stack') }
  }

  fault (error) {
    if (this.ended) return this.ended
    const { guest } = error
    if (guest === undefined) this.end(...this.trapped(error))
    else if (guest.message === 'interrupted') this.end('fuel', guest.message, guest.stack)
    else if (guest.message === 'out of memory') this.end('memory', guest.message, guest.stack)
    else if (guest.message === 'stack overflow') this.end('stack', guest.message, guest.stack)
    else if (guest.name === 'SyntaxError') this.end('syntax', `${guest.name}: ${guest.message}`, guest.stack)
    else this.end('internal', `${guest.name}: ${guest.message}`, guest.stack)
    return this.ended
  }

  trapped (error) {
    if (this.meters.fuel.value < 0) return ['fuel', 'trap']
    if (this.meters.depth.value > STACK_BYTES || error instanceof RangeError) return ['stack', 'trap']
    return ['internal', String(error)]
  }
}

module.exports = { Engine, GuestEnded }
