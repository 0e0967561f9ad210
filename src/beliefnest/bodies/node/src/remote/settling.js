'use strict'
/**
 * How one knows that a server has done what a player's client has sent: two ways with one interface, `type` for commands
 * and `settled`.
 */
const { until } = require('./waiting')

const ANSWER_MS = 5000
const TICKS = 3
// Ticks that go on there until what is not answered counts as done, or as never to be.
const SILENT_TICKS = 60

/** The server is asked for completions of a command: its answer comes after all that was sent before is done. */
class ByCompletions {
  type (bot, command) {
    bot._client.chat(`/${command}`)
  }

  /** @returns {Promise<boolean>} whether the server has done in time what the client has sent */
  settled (bot, milliseconds) {
    return bot.tabComplete('/', true, false, milliseconds).then(() => true, () => false)
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
    await until(() => isSaid || this.clock.age >= due, ANSWER_MS)
    bot.off('messagestr', hear)
    this.done += 1
  }

  /** @returns {Promise<boolean>} false if nothing goes on for so long */
  async settled (_, milliseconds) {
    let isTyped = false
    this.typed.then(() => { isTyped = true })
    while (!isTyped) {
      const { done } = this
      if (!await until(() => isTyped || this.done > done, milliseconds)) return false
    }
    const due = this.clock.age + TICKS
    return until(() => this.clock.age >= due, milliseconds)
  }
}

/**
 * Finds out whether a server answers.
 * @returns {Promise<boolean>} false if its time has gone on, and no answer came
 * @throws {Error} what `stalled` makes, if neither comes in time
 */
async function answersCompletions (bot, clock, milliseconds, stalled) {
  const asked = clock.told
  let isAnswered = false
  new ByCompletions().settled(bot, milliseconds).then(answered => { isAnswered ||= answered })
  if (!await until(() => isAnswered || clock.told >= asked + SILENT_TICKS, milliseconds)) throw stalled()
  return isAnswered
}

module.exports = { answersCompletions, ByCompletions, ByWaiting }
