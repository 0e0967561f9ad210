'use strict'
/** What a program says by its bot: it may take time, and be remembered. */

const TICK_MS = 50

/**
 * Let a bot take so many ticks for each thing it says, one after the other, and remember what a program says by it.
 * @param {object} bot
 * @param {object} options
 * @param {number} options.ticks if above 0, what says something gives a promise
 * @param {import('../memory').Memory | null} options.memory
 * @param {AbortSignal} options.signal once it is aborted, what has not been said is not said any more
 * @returns {{over: () => Promise<void>, undo: () => void}} `over` waits until all is said that was begun, `undo` lets it
 *   speak as before
 */
function ruleSpeech (bot, { ticks, memory, signal }) {
  const { chat, whisper } = bot
  let last = Promise.resolve()
  const inTurn = speak => (...words) => {
    last = last.then(() => passed(ticks, signal)).then(() => { if (!signal.aborted) speak(...words) })
    return last
  }
  const ruled = (name, speak) => {
    const act = ticks > 0 ? inTurn(speak) : speak
    if (memory === null) return act
    // A skill that speaks is remembered as a whole.
    return Object.assign((...words) => memory.say(name, words, act), { ofSkills: act })
  }
  Object.assign(bot, { chat: ruled('bot.chat', chat.bind(bot)), whisper: ruled('bot.whisper', whisper.bind(bot)) })
  return { over: () => last, undo: () => { Object.assign(bot, { chat, whisper }) } }
}

/** Resolve after so many ticks, or when the signal is aborted. */
function passed (ticks, signal) {
  return new Promise(resolve => {
    const end = () => {
      clearTimeout(timer)
      signal.removeEventListener('abort', end)
      resolve()
    }
    const timer = setTimeout(end, ticks * TICK_MS)
    signal.addEventListener('abort', end)
  })
}

module.exports = { ruleSpeech }
