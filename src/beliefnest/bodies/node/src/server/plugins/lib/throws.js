'use strict'
/**
 * Who threw what lies in a stack: rows `[agent, count, tick]`, in the order in which it is picked up;
 * what nobody threw (a block dropped it) is not among them and goes last.
 */

/** @returns {Array} the throws of two stacks that became one */
function together (some, others) {
  return [...some, ...others].sort((a, b) => a[2] - b[2])
}

/**
 * @param {Array} throws of a stack
 * @param {number} taken how many are taken out of it
 * @returns {{by: Array, left: Array}} throws of what is taken, and of what stays
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
