'use strict'
/** What is added to messages about slips that are made often, in both worlds: see build.js. */

const FARTHEST = 2
const NOT_AWAITED = ' (nothing waited for this promise: write await, or catch its error)'
// A promise has none of what it will give.
const OF_NOTHING = /^TypeError: .*(?:not a function|of undefined)$/
const UNDEFINED = /^ReferenceError: '?([\w$]{1,80})'? is not defined$/

/**
 * The name that somebody may have meant.
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

// What programs that were written for other systems call, and what stands in its place.
const ELSEWHERE = {
  require: 'a program loads no modules: bot, Vec3, goals, mcData and the skills are there',
  mineflayer: 'the bot is there already: write bot',
  pathfinder: 'write bot.pathfinder, or goToPosition(bot, position)'
}

/**
 * @param {string} message of an error
 * @param {string[]} names that a program finds in scope
 * @returns {string} what to add to a message that a name is not there, if one that is looks like it, or other systems
 *   have it; else empty
 */
function nearName (message, names) {
  const found = UNDEFINED.exec(message)
  if (found !== null && /^Goal[A-Z]/.test(found[1]) && names.includes('goals')) return `; write goals.${found[1]}`
  if (found !== null && Object.hasOwn(ELSEWHERE, found[1])) return `; ${ELSEWHERE[found[1]]}`
  const near = found === null ? null : nearest(found[1], names)
  return near === null ? '' : `; did you mean ${near}?`
}

/**
 * @param {string} message of an error
 * @param {string[]} under names of calls that had not ended when it came
 * @returns {string} what to add: who uses what a call gives before it is there gets a promise, which has none of it
 */
function notAwaited (message, under) {
  if (under.length === 0 || !OF_NOTHING.test(message)) return ''
  return ` (${under[0]} had not ended yet: was await forgotten before it?)`
}

module.exports = { NOT_AWAITED, nearName, notAwaited }
