'use strict'
/** The name that somebody may have meant. */

const FARTHEST = 2

/**
 * @param {string} wanted a short name
 * @param {string[]} names
 * @returns {?string} the nearest of the names, if at most two letters have to be changed, added or left out, or it
 *   differs in upper and lower case alone
 */
function nearest (wanted, names) {
  const ranked = names.map(name => [distance(wanted.toLowerCase(), name.toLowerCase()), name])
  const [far, name] = ranked.reduce((best, each) => (each[0] < best[0] ? each : best), [Infinity, null])
  return far <= Math.min(FARTHEST, wanted.length - 1) ? name : null
}

// Levenshtein's, row by row.
function distance (one, other) {
  let row = Array.from({ length: other.length + 1 }, (_, column) => column)
  for (let i = 1; i <= one.length; i++) {
    const above = row
    row = [i]
    for (let j = 1; j <= other.length; j++) {
      row.push(Math.min(above[j] + 1, row[j - 1] + 1, above[j - 1] + (one[i - 1] === other[j - 1] ? 0 : 1)))
    }
  }
  return row[other.length]
}

module.exports = { nearest }
