'use strict'
/** Waiting for ticks in real time, which pass slowly on a slow machine. */
const { setTimeout: sleep } = require('node:timers/promises')

const POLL_MS = 5

/**
 * Return the function with which a program's skills wait for ticks.
 * @param {object} bot
 * @param {() => number} now returns the world's current tick
 * @param {AbortSignal} ended aborted when the program has ended; this ends all waiting
 * @returns {(number: number, signal?: AbortSignal) => Promise<void>} resolves when the world has advanced by `number`
 *   ticks and the bot's physics by at least one; never once its own signal is aborted
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
