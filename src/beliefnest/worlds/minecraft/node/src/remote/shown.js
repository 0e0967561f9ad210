'use strict'
/** Block columns that a bot has received. */

const CHUNK_BITS = 4

/** Return the number of columns of a box that a bot has not received. @returns {number} */
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
