'use strict'
/** Where the interpreter's WebAssembly module comes from; a bundle replaces this file. */

const { readFileSync } = require('node:fs')

/** @returns {Uint8Array} the module as published */
function quickjsBytes () {
  return readFileSync(require.resolve('@jitl/quickjs-wasmfile-release-sync/wasm'))
}

module.exports = { quickjsBytes }
