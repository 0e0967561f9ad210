'use strict'
/** Interpreter with its meters. A bundle contains it ready-made. */

const { readFileSync } = require('node:fs')
const { meter } = require('./meter')

// Limit of the stack in estimated bytes. The JavaScript stack of Node overflows above 900,000
// (test/sandbox/engine.test.js).
const STACK_BYTES = 600_000
// Number of memory pages that the interpreter needs before a program runs. It is published with 256, which costs work
// of Node's garbage collector for every program.
const INITIAL_PAGES = 96

/** Return the interpreter as a WebAssembly module. @returns {Uint8Array} */
function interpreterBytes () {
  return meter(readFileSync(require.resolve('@jitl/quickjs-wasmfile-release-sync/wasm')), { stackBytes: STACK_BYTES, initialPages: INITIAL_PAGES })
}

module.exports = { INITIAL_PAGES, STACK_BYTES, interpreterBytes }
