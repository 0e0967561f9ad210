'use strict'
const { show, text } = require('./arguments')

/** @returns {string} what can be said at once: one line of at most so many characters, no command */
function speech (context, name, value, longest) {
  const words = text(context, name, value)
  if (words.trimStart().startsWith('/')) context.fail(`${name} must not begin with a slash, agents have no commands; it is ${show(words)}`)
  if (/[\n\r]/.test(words)) context.fail(`${name} must be one line; it is ${show(words)}. Say the lines one after the other.`)
  if (words.length > longest) context.fail(`${name} must have at most ${longest} characters; it has ${words.length}. Say it in parts.`)
  return words
}

module.exports = { speech }
