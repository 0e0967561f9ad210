'use strict'
const { show, text } = require('./arguments')
const { flawOf } = require('./text')

/** @returns {string} what can be uttered at once, or a failure */
function utterance (context, name, value, longest) {
  const words = text(context, name, value)
  const flaw = flawOf(words, longest)
  if (flaw !== null) context.fail(`${name} ${flaw}.`)
  return words
}

/** @returns {string} what can be said at once: an utterance that is no command */
function speech (context, name, value, longest) {
  const words = utterance(context, name, value, longest)
  if (words.trimStart().startsWith('/')) context.fail(`${name} must not begin with a slash, agents have no commands; it is ${show(words)}`)
  return words
}

module.exports = { speech, utterance }
