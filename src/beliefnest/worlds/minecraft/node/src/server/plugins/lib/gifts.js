'use strict'

const { withCount } = require('./items')

/** Number of ticks in which a thrown item counts as a gift to the agent who picks it up; later it counts as found. */
const GIFT_TICKS = 240

/**
 * Count the picked-up items that another agent threw a short time before as given and received.
 * @param {object[]} players players with `agent` and `countAct` (acts.js)
 * @param {number} now current tick
 * @param {object} receiver the player who picks up the item
 * @param {Array} throws rows `[agent, count, tick]` of the picked-up items (throws.js)
 * @param {object} item
 */
function handOver (players, now, receiver, throws, item) {
  for (const [agent, count, tick] of throws) {
    if (agent === receiver.agent || now - tick > GIFT_TICKS) continue
    const stack = withCount(item, count)
    players.find((other) => other.agent === agent)?.countAct('give_item_to_other', stack, receiver.agent)
    receiver.countAct('receive_item_from_other', stack, agent)
  }
}

module.exports = { handOver }
