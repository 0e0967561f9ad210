'use strict'
/** The interpreter as it is run, with its meters; a bundle has it made beforehand. */

const { readFileSync } = require('node:fs')
const { meter } = require('./meter')

// What active calls may take, in estimated bytes; the JavaScript stack of Node overflows above
// 900,000 (test/sandbox/engine.test.js).
const STACK_BYTES = 600_000
// What the interpreter needs before a program runs; published with 256, which makes work for Node's
// garbage collector at every program.
const INITIAL_PAGES = 96

/** @returns {Uint8Array} a WebAssembly module */
function interpreterBytes () {
  return meter(readFileSync(require.resolve('@jitl/quickjs-wasmfile-release-sync/wasm')), { stackBytes: STACK_BYTES, initialPages: INITIAL_PAGES })
}

module.exports = { INITIAL_PAGES, STACK_BYTES, interpreterBytes }
