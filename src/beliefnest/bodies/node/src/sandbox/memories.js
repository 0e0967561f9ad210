'use strict'
/**
 * Memories for interpreters. One that a program has left is emptied and used again: making new
 * ones keeps Node's garbage collector busy with everything else that lives in the process.
 */

const { INITIAL_PAGES } = require('./interpreter')

const PAGE = 65536
const EMPTY = Buffer.alloc(PAGE)
const MOST_KEPT = 16

class Memories {
  constructor () {
    this.free = []
  }

  /** @returns {WebAssembly.Memory} all zero, that can grow by `bytes` */
  take (bytes) {
    const maximum = INITIAL_PAGES + Math.ceil(bytes / PAGE)
    const index = this.free.findIndex(entry => entry.maximum === maximum)
    if (index < 0) return new WebAssembly.Memory({ initial: INITIAL_PAGES, maximum })
    const [{ memory }] = this.free.splice(index, 1)
    empty(Buffer.from(memory.buffer))
    return memory
  }

  /** Take back a memory that nothing uses any more; `bytes` as when it was taken. */
  give (memory, bytes) {
    if (memory.buffer.byteLength > INITIAL_PAGES * PAGE || this.free.length >= MOST_KEPT) return
    this.free.push({ memory, maximum: INITIAL_PAGES + Math.ceil(bytes / PAGE) })
  }
}

// Most of a memory was never written to; reading that is faster than writing it, and leaves it untouched.
function empty (bytes) {
  for (let place = 0; place < bytes.length; place += PAGE) {
    if (bytes.compare(EMPTY, 0, PAGE, place, place + PAGE) !== 0) bytes.fill(0, place, place + PAGE)
  }
}

module.exports = { Memories }
