'use strict'
/**
 * Instance of the interpreter, used through its exported functions. Values of the guest are pointers, plain numbers
 * here, so that a copy of an instance's memory contains them all.
 */

const { QuickJSFFI } = require('@jitl/quickjs-wasmfile-release-sync/ffi')
const loadGlue = require('@jitl/quickjs-wasmfile-release-sync/emscripten-module')

const { addTracker, setTracker } = require('./rejections')

const CHUNK = 4096
const EMPTY = Buffer.alloc(CHUNK)
// Bytes that are read of a text. The limit is above that of messages (session.js), which can thus refuse longer ones.
const MAX_TEXT = 4_000_000
const ALL_INTRINSICS = 0
const AS_SCRIPT = 0
const PENDING = 0
const FULFILLED = 1

/** Exception that the guest did not catch. */
class GuestException extends Error {
  constructor ({ name, message, stack }) {
    super(message)
    this.name = 'GuestException'
    this.guest = { name, message, stack }
  }
}

class QuickJS {
  /** Do not call this; use `QuickJS.open`. */
  constructor (glue, { fuel, depth }, tracker) {
    this.glue = glue
    this.ffi = new QuickJSFFI(glue)
    this.fuel = fuel
    this.depth = depth
    this.tracker = tracker
    this.runtime = 0
    this.context = 0
  }

  /**
   * Open an instance.
   * @param {WebAssembly.Module} module metered module
   * @param {WebAssembly.Memory} wasmMemory memory of zeros
   * @param {{call: function(number, number, number): number, interrupt: function(): boolean, rejected:
   *   function(bigint, boolean): void}} host `call` gets the number of a host function and the count and address of
   *   its arguments, and returns a value that it no longer owns, or 0; `rejected` as in rejections.js
   * @returns {Promise<QuickJS>}
   */
  static async open (module, wasmMemory, host) {
    let instance
    const glue = await loadGlue({
      wasmMemory,
      print: () => {},
      printErr: () => {},
      instantiateWasm: (imports, done) => {
        instance = new WebAssembly.Instance(module, imports)
        done(instance)
        return instance.exports
      }
    })
    glue.callbacks = {
      callFunction: (asyncify, context, self, count, values, id) => host.call(id, count, values),
      shouldInterrupt: () => host.interrupt() ? 1 : 0,
      freeHostRef: () => {}
    }
    const tracker = addTracker(instance.exports.table, (promise, handled) => host.rejected(promise, handled))
    return new QuickJS(glue, instance.exports, tracker)
  }

  /** Create a runtime and a context. */
  create (stackBytes) {
    this.runtime = this.ffi.QTS_NewRuntime()
    this.ffi.QTS_RuntimeSetMaxStackSize(this.runtime, stackBytes)
    this.ffi.QTS_RuntimeEnableInterruptHandler(this.runtime)
    setTracker(this.glue.HEAPU8.buffer, this.runtime, this.tracker)
    this.context = this.ffi.QTS_NewContext(this.runtime, ALL_INTRINSICS)
  }

  /**
   * Return the whole state of the instance; no code may be running.
   * @returns {{pages: {place: number, bytes: Uint8Array}[], runtime: number, context: number}}
   */
  save () {
    const all = this.glue.HEAPU8
    const pages = []
    for (let place = 0; place < all.length; place += CHUNK) {
      const bytes = Buffer.from(all.subarray(place, place + CHUNK))
      if (!bytes.equals(EMPTY)) pages.push({ place, bytes })
    }
    return { pages, runtime: this.runtime, context: this.context }
  }

  /** Load the state that another instance of the same module saved. This instance must be new. */
  restore ({ pages, runtime, context }) {
    for (const { place, bytes } of pages) this.glue.HEAPU8.set(bytes, place)
    this.runtime = runtime
    this.context = context
  }

  limitMemory (bytes) {
    this.ffi.QTS_RuntimeSetMemoryLimit(this.runtime, bytes)
  }

  /** Return a host function with a number of its own. @returns {number} */
  hostFunction (name, id) {
    return this.ffi.QTS_NewFunction(this.context, name, 1, false, id)
  }

  string (text) {
    const pointer = this.characters(text)
    const value = this.ffi.QTS_NewString(this.context, pointer)
    this.glue._free(pointer)
    return value
  }

  number (value) {
    return this.ffi.QTS_NewFloat64(this.context, value)
  }

  /** Return an array buffer at a known address, which can be read whatever state the guest is in. */
  buffer (length) {
    const place = this.allocate(length)
    this.glue.HEAPU8.fill(0, place, place + length)
    return { place, value: this.ffi.QTS_NewArrayBuffer(this.context, place, length) }
  }

  /** Return a value as a text of at most `MAX_TEXT` bytes. @returns {string} */
  text (value) {
    const pointer = this.ffi.QTS_GetString(this.context, value)
    const text = this.glue.UTF8ToString(pointer, MAX_TEXT).toWellFormed()
    this.ffi.QTS_FreeCString(this.context, pointer)
    return text
  }

  /** Return the text of an argument of a host function. @returns {string} */
  argument (values, index) {
    return this.text(this.ffi.QTS_ArgvGetJSValueConstPointer(values, index))
  }

  /** Return a value that keeps alive a JSValue of the interpreter. @returns {number} */
  keep (bits) {
    const place = this.allocate(8)
    new BigUint64Array(this.glue.HEAPU8.buffer, place, 1)[0] = BigInt.asUintN(64, bits)
    const value = this.ffi.QTS_DupValuePointer(this.context, place)
    this.glue._free(place)
    return value
  }

  free (value) {
    this.ffi.QTS_FreeValuePointer(this.context, value)
  }

  property (value, name) {
    const key = this.string(name)
    const property = this.ffi.QTS_GetProp(this.context, value, key)
    this.free(key)
    return property
  }

  /** Evaluate a text. @throws {GuestException} */
  evaluate (code, fileName) {
    const pointer = this.characters(code)
    const value = this.ffi.QTS_Eval(this.context, pointer, this.glue.lengthBytesUTF8(code), fileName, 0, AS_SCRIPT)
    this.glue._free(pointer)
    return this.checked(value)
  }

  /** Call a function. @throws {GuestException} */
  call (callee, args) {
    const place = this.allocate(args.length * 4)
    new Uint32Array(this.glue.HEAPU8.buffer, place, args.length).set(args)
    const value = this.ffi.QTS_Call(this.context, callee, this.ffi.QTS_GetUndefined(), args.length, place)
    this.glue._free(place)
    return this.checked(value)
  }

  get hasJobs () {
    return this.ffi.QTS_IsJobPending(this.runtime) !== 0
  }

  /** Run promise jobs. @throws {GuestException} */
  runJobs (most) {
    const context = this.allocate(4)
    const value = this.ffi.QTS_ExecutePendingJob(this.runtime, most, context)
    this.glue._free(context)
    this.free(this.checked(value))
  }

  /** Return the state of a promise. @returns {'pending'|'fulfilled'|'rejected'} */
  promiseState (promise) {
    const state = this.ffi.QTS_PromiseState(this.context, promise)
    return state === PENDING ? 'pending' : state === FULFILLED ? 'fulfilled' : 'rejected'
  }

  promiseResult (promise) {
    return this.ffi.QTS_PromiseResult(this.context, promise)
  }

  checked (value) {
    const error = this.ffi.QTS_ResolveException(this.context, value)
    if (error === 0) return value
    const [name, message, stack] = ['name', 'message', 'stack'].map((key) => this.text(this.property(error, key)))
    throw new GuestException({ name, message, stack })
  }

  characters (text) {
    const length = this.glue.lengthBytesUTF8(text) + 1
    const pointer = this.allocate(length)
    this.glue.stringToUTF8(text, pointer, length)
    return pointer
  }

  allocate (length) {
    const place = this.glue._malloc(Math.max(length, 1))
    if (place === 0) throw new GuestException({ name: 'InternalError', message: 'out of memory', stack: '' })
    return place
  }
}

module.exports = { QuickJS, GuestException }
