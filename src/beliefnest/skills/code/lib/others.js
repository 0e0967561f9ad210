'use strict'
const { otherAgent } = require('./arguments')

/** Return the other agent's entity as the bot sees it; fail if it sees none. */
function bodyOf (context, name, value) {
  const { bot, fail } = context
  const other = otherAgent(context, name, value)
  const { entity } = bot.players[other]
  if (!entity) fail(`${other} is ${bot.perceived === undefined ? 'nowhere near' : 'not to be seen'}. Find out where ${other} is first.`)
  return entity
}

module.exports = { bodyOf }
