'use strict'
/**
 * Pool of memories for interpreters. A memory is cleared and used again, because new ones keep Node's garbage
 * collector busy with all other objects of the process.
 */

const { INITIAL_PAGES } = require('./interpreter')

const PAGE = 65536
const EMPTY = Buffer.alloc(PAGE)
const MOST_KEPT = 16

class Memories {
  constructor () {
    this.free = []
  }

  /** Return a memory of zeros that can grow by `bytes`. @returns {WebAssembly.Memory} */
  take (bytes) {
    const maximum = INITIAL_PAGES + Math.ceil(bytes / PAGE)
    const index = this.free.findIndex(entry => entry.maximum === maximum)
    if (index < 0) return new WebAssembly.Memory({ initial: INITIAL_PAGES, maximum })
    const [{ memory }] = this.free.splice(index, 1)
    empty(Buffer.from(memory.buffer))
    return memory
  }

  /** Take back an unused memory; `bytes` as in `take`. */
  give (memory, bytes) {
    if (memory.buffer.byteLength > INITIAL_PAGES * PAGE || this.free.length >= MOST_KEPT) return
    this.free.push({ memory, maximum: INITIAL_PAGES + Math.ceil(bytes / PAGE) })
  }
}

// Clear only parts that were written to. Most of a memory was not; reading is faster than writing, and leaves pages
// untouched.
function empty (bytes) {
  for (let place = 0; place < bytes.length; place += PAGE) {
    if (bytes.compare(EMPTY, 0, PAGE, place, place + PAGE) !== 0) bytes.fill(0, place, place + PAGE)
  }
}

module.exports = { Memories }
