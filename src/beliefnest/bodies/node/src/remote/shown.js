'use strict'
/** The columns of blocks that a bot has been shown. */

const CHUNK_BITS = 4

/** @returns {number} columns of a box that a bot has not been shown */
function columnsLacking ({ world }, { low, high }) {
  let lacking = 0
  for (let x = low[0] >> CHUNK_BITS; x <= high[0] >> CHUNK_BITS; x++) {
    for (let z = low[2] >> CHUNK_BITS; z <= high[2] >> CHUNK_BITS; z++) {
      if (!world.getColumn(x, z)) lacking += 1
    }
  }
  return lacking
}

module.exports = { columnsLacking }
