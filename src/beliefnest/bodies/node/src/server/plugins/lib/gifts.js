'use strict'

const { withCount } = require('./items')

/** How long what was thrown is a gift to whoever picks it up; later it is found. */
const GIFT_TICKS = 240

/**
 * What somebody threw and somebody else picks up was given, unless it lay there for long.
 * @param {object[]} players by `agent`, who count acts (acts.js)
 * @param {number} now the tick
 * @param {object} receiver one of them
 * @param {Array} throws rows `[agent, count, tick]` of what is picked up (throws.js)
 * @param {object} item
 */
function handOver (players, now, receiver, throws, item) {
  for (const [agent, count, tick] of throws) {
    if (agent === receiver.agent || now - tick > GIFT_TICKS) continue
    const given = withCount(item, count)
    players.find((other) => other.agent === agent)?.countAct('give_item_to_other', given, receiver.agent)
    receiver.countAct('receive_item_from_other', given, agent)
  }
}

module.exports = { handOver }
