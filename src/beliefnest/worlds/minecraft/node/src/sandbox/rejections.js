'use strict'
/**
 * Tracking of rejected promises without a handler. QuickJS calls a tracker function whose table index is stored in its
 * runtime. This build exports no call to set the tracker, so that this module writes the index into the memory.
 * engine.js checks once that the tracker is called.
 */

// Address of the tracker's index in the runtime, in bytes: two words behind the interrupt handler.
const PLACE = 160

// (module (import "h" "t" (func (param i32 i64 i64 i32 i32))) (export "t" (func 0))). A table can contain only
// WebAssembly functions, so that the JavaScript function needs this wrapper.
const TYPED = Uint8Array.from([
  0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00,
  0x01, 0x09, 0x01, 0x60, 0x05, 0x7f, 0x7e, 0x7e, 0x7f, 0x7f, 0x00,
  0x02, 0x07, 0x01, 0x01, 0x68, 0x01, 0x74, 0x00, 0x00,
  0x07, 0x05, 0x01, 0x01, 0x74, 0x00, 0x00
])
const typed = new WebAssembly.Module(TYPED)

/**
 * Add a tracker function to the table.
 * @param {WebAssembly.Table} table table of an instance of the interpreter
 * @param {function(bigint, boolean): void} report called with the promise, a JSValue, when it is rejected without a
 *   handler (false), or when it has got a handler after all (true)
 * @returns {number} the function's index, the same for every instance
 */
function addTracker (table, report) {
  const track = (context, promise, reason, handled) => report(promise, handled !== 0)
  return table.grow(1, new WebAssembly.Instance(typed, { h: { t: track } }).exports.t)
}

/** Set the tracker of a runtime. */
function setTracker (memory, runtime, number) {
  new Uint32Array(memory, runtime + PLACE, 1)[0] = number
}

module.exports = { addTracker, setTracker }
