'use strict'
/** Path finding under a clock that stands still while code runs. */

// What looking at one node of a path costs in virtual time; with the pathfinder's 40 ms a tick
// that is 400 nodes a tick, and 40,000 until it gives up.
const NODE_MS = 0.1

/**
 * Charges the bot's pathfinder for its search, and keeps it from changing the world on its
 * way: agents walk around walls, they do not dig through them.
 */
function chargePathfinder (bot, clock) {
  const setMovements = bot.pathfinder.setMovements
  const charged = movements => {
    const getNeighbors = movements.getNeighbors
    movements.getNeighbors = node => {
      clock.charge(NODE_MS)
      return getNeighbors.call(movements, node)
    }
    return movements
  }
  const standard = charged(bot.pathfinder.movements)
  standard.canDig = false
  standard.allow1by1towers = false
  standard.scafoldingBlocks = []
  bot.pathfinder.setMovements = movements => {
    const known = Object.hasOwn(movements, 'getNeighbors')
    setMovements(known ? movements : charged(movements))
  }
}

module.exports = { chargePathfinder }
