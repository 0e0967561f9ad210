'use strict'
/**
 * Two ways to know that a server has done what a player's client has sent, with one interface: `type` for commands, and
 * `settled`, which takes `until` of an Operator to wait with.
 */
const { setTimeout: sleep } = require('node:timers/promises')

const POLL_MS = 10
const TICKS = 3
// Ticks that go on there until what is not answered counts as done, or as never to be.
const SILENT_TICKS = 60
const MOST_NUMBERS = 1_000_000

/** The server is asked for completions of a command: its answer comes after all that was sent before is done. */
class ByCompletions {
  constructor () {
    this.last = 0
  }

  type (bot, command) {
    bot._client.chat(`/${command}`)
  }

  /** @returns {Promise<boolean>} true if the server has done within so many ticks what the client has sent */
  async settled ({ _client: client }, until, ticks) {
    const number = this.last = this.last % MOST_NUMBERS + 1
    let isAnswered = false
    // An answer to an earlier question says nothing about what was sent since.
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
 * For servers that do not answer such requests, and may do at the same time what was typed one after the other: commands
 * are typed singly, and a few ticks waited for. That is a wait and no proof; what it was for is looked at afterwards.
 */
class ByWaiting {
  /** @param {import('./serverClock').ServerClock} clock */
  constructor (clock) {
    this.clock = clock
    this.typed = Promise.resolve()
    this.done = 0
  }

  /** Types a command when something was said to the last one. */
  type (bot, command) {
    this.typed = this.typed.then(() => this.said(bot, command))
  }

  async said (bot, command) {
    let isSaid = false
    const hear = (_, position) => { isSaid ||= position === 'system' }
    bot.on('messagestr', hear)
    bot._client.chat(`/${command}`)
    const due = this.clock.age + SILENT_TICKS
    while (!isSaid && !bot._client.ended && this.clock.age < due) await sleep(POLL_MS)
    bot.off('messagestr', hear)
    this.done += 1
  }

  /** @returns {Promise<boolean>} false if nothing is done for so many ticks */
  async settled (_, until, ticks) {
    let isTyped = false
    this.typed.then(() => { isTyped = true })
    while (!isTyped) {
      const { done } = this
      if (!await until(() => isTyped || this.done > done, ticks)) return false
    }
    const due = this.clock.age + TICKS
    return until(() => this.clock.age >= due, ticks)
  }
}

/** @returns {Promise<boolean>} true if a server answers requests for completions; false if its time goes on without an answer */
function answersCompletions (operator) {
  return new ByCompletions().settled(operator.bot, (condition, ticks) => operator.until(condition, ticks), SILENT_TICKS)
}

module.exports = { answersCompletions, ByCompletions, ByWaiting }
