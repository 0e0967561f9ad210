'use strict'
/**
 * Two ways to find out that a server has handled everything a player's client has sent. Both have the same interface:
 * `type` for commands, and `settled`, which waits by the `until` of an Operator.
 */
const { setTimeout: sleep } = require('node:timers/promises')

const POLL_MS = 10
const TICKS = 3
// Number of server ticks after which a missing answer is no longer expected.
const SILENT_TICKS = 60
const MOST_NUMBERS = 1_000_000

/** Settling by a request for completions of a command: the server answers it after everything that was sent before. */
class ByCompletions {
  constructor () {
    this.last = 0
  }

  type (bot, command) {
    bot._client.chat(`/${command}`)
  }

  /**
   * Return true if the server has handled everything that the client has sent, within a number of ticks.
   * @returns {Promise<boolean>}
   */
  async settled ({ _client: client }, until, ticks) {
    const number = this.last = this.last % MOST_NUMBERS + 1
    let isAnswered = false
    // An answer to an earlier request says nothing about packets sent since.
    const hear = ({ transactionId }) => { isAnswered ||= transactionId === number }
    client.on('tab_complete', hear)
    client.write('tab_complete', { transactionId: number, text: '/' })
    try {
      await until(() => isAnswered || client.ended, ticks)
    } finally {
      client.off('tab_complete', hear)
    }
    return isAnswered
  }
}

/**
 * Settling for servers that do not answer such requests and may execute commands in parallel: commands are typed one
 * by one, each followed by a wait of a few ticks. The wait proves nothing; therefore callers check the effect
 * afterwards.
 */
class ByWaiting {
  /**
   * @param {import('./serverClock').ServerClock} clock
   */
  constructor (clock) {
    this.clock = clock
    this.typed = Promise.resolve()
    this.done = 0
  }

  /** Type a command after the server has answered the last one. */
  type (bot, command) {
    this.typed = this.typed.then(() => this.said(bot, command))
  }

  async said (bot, command) {
    let isSaid = false
    const hear = (_, position) => { isSaid ||= position === 'system' }
    bot.on('messagestr', hear)
    bot._client.chat(`/${command}`)
    const due = this.clock.followed + SILENT_TICKS
    while (!isSaid && !bot._client.ended && this.clock.followed < due) await sleep(POLL_MS)
    bot.off('messagestr', hear)
    this.done += 1
  }

  /** Wait a few ticks. @returns {Promise<boolean>} false if nothing is done within a number of ticks */
  async settled (_, until, ticks) {
    let isTyped = false
    this.typed.then(() => { isTyped = true })
    while (!isTyped) {
      const { done } = this
      if (!await until(() => isTyped || this.done > done, ticks)) return false
    }
    const due = this.clock.followed + TICKS
    return until(() => this.clock.followed >= due, ticks)
  }
}

/**
 * Return true if a server answers requests for completions; false if its time goes on without an answer.
 * @returns {Promise<boolean>}
 */
function answersCompletions (operator) {
  return new ByCompletions().settled(operator.bot, (condition, ticks) => operator.until(condition, ticks), SILENT_TICKS)
}

module.exports = { answersCompletions, ByCompletions, ByWaiting }
