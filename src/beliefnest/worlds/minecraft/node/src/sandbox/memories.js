'use strict'
/**
 * Pool of memories for interpreters. A used memory is cleared and used again. Each new one would make Node's garbage
 * collector examine all objects of the process.
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

// Clear only the pages that are not empty. Most pages were never written to. Comparing them is faster than writing, and
// the operating system need not allocate them.
function empty (bytes) {
  for (let place = 0; place < bytes.length; place += PAGE) {
    if (bytes.compare(EMPTY, 0, PAGE, place, place + PAGE) !== 0) bytes.fill(0, place, place + PAGE)
  }
}

module.exports = { Memories }
