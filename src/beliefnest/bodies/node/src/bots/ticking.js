'use strict'
/** Waiting for ticks in real time, which pass slowly on a slow machine. */
const { setTimeout: sleep } = require('node:timers/promises')

const POLL_MS = 5

/**
 * Make the function by which a program's skills wait for ticks.
 * @param {object} bot
 * @param {() => number} now the tick that the world is in
 * @param {AbortSignal} ended aborted when the program has ended, which ends all waiting
 * @returns {(number: number, signal?: AbortSignal) => Promise<void>} resolves when the world has gone on by so many ticks, and
 *   the bot's body by one at least; never once its own signal is aborted
 */
function waitFor (bot, now, ended) {
  return async (number, signal) => {
    const due = now() + number
    let hasMoved = !bot.physicsEnabled
    const move = () => { hasMoved = true }
    bot.on('physicsTick', move)
    while (!ended.aborted && !signal?.aborted && (now() < due || !hasMoved)) await sleep(POLL_MS)
    bot.removeListener('physicsTick', move)
    if (signal?.aborted) await new Promise(() => {})
  }
}

module.exports = { waitFor }
