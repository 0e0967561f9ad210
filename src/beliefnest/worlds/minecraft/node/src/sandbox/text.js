'use strict'
/** Texts of programs: replacement of lone surrogates, and cutting to a length. */

// Escape of a surrogate in JSON; it may also be part of a pair.
const SURROGATE = /\\ud[89a-f]/i

/**
 * Parse JSON that a program has made.
 * @param {string} text JSON
 * @returns {*} its value; lone surrogates in texts become U+FFFD
 * @throws {SyntaxError}
 */
function parsed (text) {
  const whole = text.toWellFormed()
  if (!SURROGATE.test(whole)) return JSON.parse(whole)
  return JSON.parse(whole, (key, value) => typeof value === 'string' ? value.toWellFormed() : value)
}

/** Return at most `most` characters of a text, without splitting a surrogate pair. @returns {string} */
function cut (text, most) {
  return text.slice(0, most).toWellFormed()
}

/** Return the message about more than `most` characters in one message of a program. @returns {string} */
function tooMuch (most) {
  return `more than ${most} characters leave the program at once, which is the limit`
}

module.exports = { parsed, cut, tooMuch }
