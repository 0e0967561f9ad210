'use strict'
/**
 * Hearing of promises that are rejected and nothing waits for. QuickJS calls a function of the table
 * that its runtime names, and the build has no call to name one: this does it by hand. Whoever
 * uses it checks once that it is called (engine.js).
 */

// Where the runtime has the function's number, in bytes: two words behind the interrupt handler.
const PLACE = 160

// (module (import "h" "t" (func (param i32 i64 i64 i32 i32))) (export "t" (func 0))): only a function
// of WebAssembly can be in a table.
const TYPED = Uint8Array.from([
  0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00,
  0x01, 0x09, 0x01, 0x60, 0x05, 0x7f, 0x7e, 0x7e, 0x7f, 0x7f, 0x00,
  0x02, 0x07, 0x01, 0x01, 0x68, 0x01, 0x74, 0x00, 0x00,
  0x07, 0x05, 0x01, 0x01, 0x74, 0x00, 0x00
])
const typed = new WebAssembly.Module(TYPED)

/**
 * @param {WebAssembly.Table} table of an instance of the interpreter
 * @param {function(bigint, boolean): void} told a promise was rejected without a handler, or
 *   (true) has got one after all; the promise is a JSValue
 * @returns {number} the function's number, the same for every instance
 */
function addTracker (table, told) {
  const track = (context, promise, reason, handled) => told(promise, handled !== 0)
  return table.grow(1, new WebAssembly.Instance(typed, { h: { t: track } }).exports.t)
}

/** Let a runtime call the function of that number. */
function setTracker (memory, runtime, number) {
  new Uint32Array(memory, runtime + PLACE, 1)[0] = number
}

module.exports = { addTracker, setTracker }
