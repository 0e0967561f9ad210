'use strict'
/** Walking straight ahead, without a search for a path. */
const { until } = require('./waiting')

/**
 * Walk in the direction of view until a condition holds. The condition is checked at every physics step: a busy
 * machine makes many steps at once, and a check after them would come too late.
 * @returns {Promise<boolean>} true if it came to hold within `limit` ticks
 */
async function stepUntil (context, condition, limit) {
  const { bot, listen } = context
  let arrived = false
  let fault = null
  // Keep a fault of the condition here: physics must not throw the error of a program that has ended.
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
