'use strict'
/** Hints that are appended to messages about frequent mistakes, in both worlds (see build.js). */

const FARTHEST = 2
const NOT_AWAITED = ' (nothing waited for this promise: write await, or catch its error)'
// Typical error when a property of the result is read from a promise that was not awaited.
const OF_NOTHING = /^TypeError: .*(?:not a function|of undefined)$/
const UNDEFINED = /^ReferenceError: '?([\w$]{1,80})'? is not defined$/

/**
 * Return the name that the author may have meant.
 * @param {string} wanted misspelled name
 * @param {string[]} names existing names
 * @returns {?string} the nearest name, if at most two letters have to be changed, added or left out, or only upper and
 *   lower case differ
 */
function nearest (wanted, names) {
  const ranked = names.map(name => [distance(wanted.toLowerCase(), name.toLowerCase()), name])
  const [far, name] = ranked.reduce((best, each) => (each[0] < best[0] ? each : best), [Infinity, null])
  return far <= Math.min(FARTHEST, wanted.length - 1) ? name : null
}

// Return the Levenshtein distance, computed row by row.
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

// Names that programs for other systems use, each with its replacement here.
const ELSEWHERE = {
  require: 'a program loads no modules: bot, Vec3, goals, mcData and the skills are there',
  mineflayer: 'the bot is there already: write bot',
  pathfinder: 'write bot.pathfinder, or goToPosition(bot, position)'
}

/**
 * Return a hint for a message about an undefined name.
 * @param {string} message message of the error
 * @param {string[]} names names in scope of the program
 * @param {Object<string, string>} [elsewhere] names that are not in scope, each with its hint
 * @returns {string} a similar name in scope, or the replacement of a name from another system; otherwise empty
 */
function nearName (message, names, elsewhere = ELSEWHERE) {
  const match = UNDEFINED.exec(message)
  if (match !== null && /^Goal[A-Z]/.test(match[1]) && names.includes('goals')) return `; write goals.${match[1]}`
  if (match !== null && Object.hasOwn(elsewhere, match[1])) return `; ${elsewhere[match[1]]}`
  const near = match === null ? null : nearest(match[1], names)
  return near === null ? '' : `; did you mean ${near}?`
}

/**
 * Return a hint for a message that a missing `await` may have caused: a promise has none of its result's properties.
 * @param {string} message message of the error
 * @param {string[]} under names of calls that had not ended at that moment
 * @returns {string} empty if there was no such call
 */
function notAwaited (message, under) {
  if (under.length === 0 || !OF_NOTHING.test(message)) return ''
  return ` (${under[0]} had not ended yet: was await forgotten before it?)`
}

module.exports = { ELSEWHERE, NOT_AWAITED, nearName, notAwaited }
