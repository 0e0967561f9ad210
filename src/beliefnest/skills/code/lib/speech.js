'use strict'
const { show, text } = require('./arguments')
const { flawOf } = require('./text')

/** Return a text that can be uttered as one message; fail otherwise. @returns {string} */
function utterance (context, name, value, longest) {
  const words = text(context, name, value)
  const flaw = flawOf(words, longest)
  if (flaw !== null) context.fail(`${name} ${flaw}.`)
  return words
}

/** Return a text that can be said: an utterance that is not a command. @returns {string} */
function speech (context, name, value, longest) {
  const words = utterance(context, name, value, longest)
  if (words.trimStart().startsWith('/')) context.fail(`${name} must not begin with a slash, agents have no commands; it is ${show(words)}`)
  return words
}

module.exports = { speech, utterance }
