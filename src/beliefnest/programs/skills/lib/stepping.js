'use strict'
/** Going straight on, without a search for a way. */
const { until } = require('./waiting')

/**
 * Go on to where the bot looks until a condition holds. It is judged step by step: a busy machine takes many
 * steps at once, and who looks after them is far beyond.
 * @returns {Promise<boolean>} true if it came to hold within `limit` ticks
 */
async function stepUntil (context, condition, limit) {
  const { bot, listen } = context
  let arrived = false
  let fault = null
  // Whoever makes the steps must not get what is thrown to a program that has ended.
  const stop = listen('physicsTick', () => {
    if (arrived || fault !== null) return
    try {
      arrived = condition()
      if (arrived) bot.setControlState('forward', false)
    } catch (error) {
      fault = error
    }
  })
  try {
    bot.setControlState('forward', true)
    await until(context, () => arrived || fault !== null, limit)
  } finally {
    stop()
  }
  if (fault !== null) throw fault
  bot.setControlState('forward', false)
  return arrived
}

module.exports = { stepUntil }
