'use strict'
/** Waiting for what a server does in its own time. */
const { setTimeout: sleep } = require('node:timers/promises')

const POLL_MS = 10
const CHUNK_BITS = 4

/** @returns {Promise<boolean>} whether the condition held in time */
async function until (condition, milliseconds) {
  const end = performance.now() + milliseconds
  while (!condition()) {
    if (performance.now() > end) return false
    await sleep(POLL_MS)
  }
  return true
}

/** Whether a bot has been shown all columns of a box. */
function hasColumns ({ world }, { low, high }) {
  for (let x = low[0] >> CHUNK_BITS; x <= high[0] >> CHUNK_BITS; x++) {
    for (let z = low[2] >> CHUNK_BITS; z <= high[2] >> CHUNK_BITS; z++) {
      if (!world.getColumn(x, z)) return false
    }
  }
  return true
}

module.exports = { hasColumns, until }
