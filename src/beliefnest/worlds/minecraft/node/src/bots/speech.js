'use strict'
/** Methods of a program's bot: speech can take time, and a memory can record speech and waits. */

const TICK_MS = 50

/**
 * Make each utterance of a bot take a number of ticks, one after the other, and record the program's utterances and
 * waits in its memory.
 * @param {object} bot
 * @param {object} options
 * @param {number} options.ticks ticks per utterance; if above 0, methods that speak return a promise
 * @param {import('../memory').Memory | null} options.memory
 * @param {boolean} options.isMute whether every utterance fails
 * @param {AbortSignal} options.signal when it is aborted, utterances that are still waiting are dropped
 * @returns {{over: () => Promise<void>, undo: () => void}} `over` waits until all utterances that began are said;
 *   `undo` restores the bot's own methods
 */
function ruleSpeech (bot, { ticks, memory, isMute, signal }) {
  const { chat, whisper, waitForTicks } = bot
  let last = Promise.resolve()
  const inTurn = speak => (...words) => {
    last = last.then(() => passed(ticks, signal)).then(() => { if (!signal.aborted) speak(...words) })
    return last
  }
  const refuse = () => { throw new Error(`${bot.username} may not speak here`) }
  const ruled = (name, speak) => {
    const act = isMute ? refuse : ticks > 0 ? inTurn(speak) : speak
    if (memory === null) return act
    // Skills use the unrecorded method: the memory records a skill that speaks as a whole.
    return Object.assign((...words) => memory.say(name, words, act), { ofSkills: act })
  }
  Object.assign(bot, { chat: ruled('bot.chat', chat.bind(bot)), whisper: ruled('bot.whisper', whisper.bind(bot)) })
  // Skills and the bot's own code wait by other means.
  if (memory !== null) bot.waitForTicks = (...args) => memory.call('bot.waitForTicks', args, waitForTicks)
  return { over: () => last, undo: () => { Object.assign(bot, { chat, whisper, waitForTicks }) } }
}

/** Resolve after a number of ticks, or when the signal is aborted. */
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
