'use strict'
/** Speech that takes time: whoever says something is heard when its ticks are over, one thing after the other. */

const TICK_MS = 50

/**
 * Lets a bot take so many ticks for each thing it says; those calls then give promises.
 * @param {object} bot
 * @param {number} ticks
 * @param {AbortSignal} signal once it is aborted, what has not been said is not said any more
 * @returns {{over: () => Promise<void>, quicken: () => void}} `over` waits until all is said that was begun, `quicken` lets
 *   it speak as before
 */
function slowSpeech (bot, ticks, signal) {
  const { chat, whisper } = bot
  let last = Promise.resolve()
  const inTurn = speak => (...words) => {
    last = last.then(() => passed(ticks, signal)).then(() => { if (!signal.aborted) speak(...words) })
    return last
  }
  Object.assign(bot, { chat: inTurn(chat.bind(bot)), whisper: inTurn(whisper.bind(bot)) })
  return { over: () => last, quicken: () => { Object.assign(bot, { chat, whisper }) } }
}

/** Resolves after so many ticks, or when the signal is aborted. */
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

module.exports = { slowSpeech }
