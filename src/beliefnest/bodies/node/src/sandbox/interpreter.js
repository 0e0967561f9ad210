'use strict'
/** The interpreter as it is run, with its meters; a bundle has it made beforehand. */

const { readFileSync } = require('node:fs')
const { meter } = require('./meter')

// What active calls may take, in estimated bytes; the JavaScript stack of Node overflows above
// 900,000 (test/sandbox/engine.test.js).
const STACK_BYTES = 600_000

/** @returns {Uint8Array} a WebAssembly module */
function interpreterBytes () {
  return meter(readFileSync(require.resolve('@jitl/quickjs-wasmfile-release-sync/wasm')), { stackBytes: STACK_BYTES })
}

module.exports = { STACK_BYTES, interpreterBytes }
