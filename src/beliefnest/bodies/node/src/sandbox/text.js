'use strict'
/** Texts of programs: made well-formed, cut to a length. */

// JSON names half a character by this; a whole pair may be written so too.
const SURROGATE = /\\ud[89a-f]/i

/**
 * @param {string} text JSON that a program has made
 * @returns {*} its value, in which no text has half a character (each becomes U+FFFD)
 * @throws {SyntaxError}
 */
function parsed (text) {
  const whole = text.toWellFormed()
  if (!SURROGATE.test(whole)) return JSON.parse(whole)
  return JSON.parse(whole, (key, value) => typeof value === 'string' ? value.toWellFormed() : value)
}

/** @returns {string} at most `most` characters of a text, none of them halved */
function cut (text, most) {
  return text.slice(0, most).toWellFormed()
}

module.exports = { parsed, cut }
