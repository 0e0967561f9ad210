'use strict'
/**
 * Throws of the items in a stack: rows `[agent, count, tick]`, in the order in which they are picked up. Items that
 * nobody threw, such as a block's drops, have no row and come last.
 */

/** Return the throws of two merged stacks. @returns {Array} */
function together (some, others) {
  return [...some, ...others].sort((a, b) => a[2] - b[2])
}

/**
 * Split the throws of a stack.
 * @param {Array} throws throws of the stack
 * @param {number} taken number of items that are taken out of it
 * @returns {{by: Array, left: Array}} throws of the taken items, and of the rest
 */
function without (throws, taken) {
  const [by, left] = [[], []]
  let open = taken
  for (const [agent, count, tick] of throws) {
    const now = Math.min(count, open)
    open -= now
    if (now > 0) by.push([agent, now, tick])
    if (now < count) left.push([agent, count - now, tick])
  }
  return { by, left }
}

module.exports = { together, without }
