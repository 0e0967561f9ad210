'use strict'
const { otherAgent } = require('./arguments')

/** The other agent's body as the bot sees it, or a failure. */
function bodyOf (context, name, value) {
  const { bot, fail } = context
  const other = otherAgent(context, name, value)
  const { entity } = bot.players[other]
  if (!entity) fail(`${other} is ${bot.perceived === undefined ? 'nowhere near' : 'not to be seen'}. Find out where ${other} is first.`)
  return entity
}

module.exports = { bodyOf }
