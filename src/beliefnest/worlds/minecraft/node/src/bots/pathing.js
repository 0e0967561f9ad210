'use strict'
/** Path finding with limits on the number of nodes instead of time, so that a slow machine finds the same paths. */

// Time in milliseconds charged for one node of a path search. The pathfinder's limit of 40 ms in a tick then allows 427
// nodes in a tick, and its limit of 5 s allows 53,000 nodes in a search. The value is a binary fraction, so that adding
// it to a clock never rounds.
const NODE_MS = 3 / 32

// Block of a search below the box. With air there, a search would look for ground to fall to at all heights below.
const NOTHING = { safe: false, physical: false, liquid: false, climbable: false, replaceable: false, canFall: false, openable: false }

/**
 * Limit the bot's path searches by their number of nodes, and keep the pathfinder from changing the world: agents walk
 * around walls and do not dig through them. A move costs at least its length, as in the scripted world: a drop by three
 * blocks takes a bot as long as three steps, for which the pathfinder charges one. `bot.pathfinder.reset()` undoes the settings of a program.
 * @param {object} bot
 * @param {{charge?: (ms: number) => void}} clock charges for each node; without `charge` time is real and nodes are
 *   only counted
 * @param {(x: number, y: number, z: number, isBelow: boolean) => object | undefined} [unknownAt] returns the assumed
 *   block for a position that the bot does not know; undefined for known positions
 */
function chargePathfinder (bot, clock, unknownAt) {
  const setMovements = bot.pathfinder.setMovements
  const charged = movements => {
    const getNeighbors = movements.getNeighbors
    movements.getNeighbors = node => {
      clock.charge?.(NODE_MS)
      return getNeighbors.call(movements, node).map(move => Object.assign(move, { cost: Math.max(move.cost, Math.hypot(move.x - node.x, move.y - node.y, move.z - node.z)) }))
    }
    rememberBlocks(movements, bot, unknownAt)
    rememberEntities(movements)
    return movements
  }
  if (clock.charge === undefined) countNodes(bot.pathfinder)
  const standard = charged(bot.pathfinder.movements)
  standard.canDig = false
  standard.allow1by1towers = false
  standard.scafoldingBlocks = []
  bot.pathfinder.setMovements = movements => {
    const isCharged = Object.hasOwn(movements, 'getNeighbors')
    setMovements(isCharged ? movements : charged(movements))
  }
  const { thinkTimeout, tickTimeout, searchRadius } = bot.pathfinder
  bot.pathfinder.reset = () => {
    Object.assign(bot.pathfinder, { thinkTimeout, tickTimeout, searchRadius })
    if (bot.pathfinder.movements !== standard) setMovements(standard)
  }
}

/**
 * Replace the time limits of searches by equivalent numbers of nodes. A search that reaches its limit
 * for a tick without any path is reported as failed. With limits in real time this would also happen when the operating
 * system pauses the process for 40 ms.
 */
function countNodes (pathfinder) {
  const { getPathFromTo } = pathfinder
  pathfinder.getPathFromTo = function * (movements, from, goal, options = {}) {
    const { timeout = pathfinder.thinkTimeout, tickTimeout = pathfinder.tickTimeout } = options
    // Start the search with a tick limit below zero, so that it has expanded no node yet.
    const results = getPathFromTo(movements, from, goal, { ...options, timeout: Infinity, tickTimeout: -1 })
    limit(results.next().value.astarContext, nodesIn(tickTimeout), nodesIn(timeout))
    yield * results
  }
}

/**
 * Return the number of nodes for a time limit: a search continues until the elapsed time exceeds the limit, hence + 1.
 */
const nodesIn = milliseconds => Math.max(Math.floor(milliseconds / NODE_MS) + 1, 1)

/**
 * Limit an A* search to a number of nodes per continuation and in total. The open heap claims to be empty when the
 * nodes are used up; the status is corrected afterwards.
 */
function limit (search, atOnce, inAll) {
  const { openHeap } = search
  const isExhausted = openHeap.isEmpty.bind(openHeap)
  const compute = search.compute.bind(search)
  let left = 0
  search.tickTimeout = Infinity
  openHeap.isEmpty = () => isExhausted() || left-- <= 0
  search.compute = () => {
    left = Math.min(atOnce, inAll - search.closedDataSet.size)
    const result = compute()
    if (result.status !== 'noPath' || isExhausted()) return result
    return { ...result, status: search.closedDataSet.size < inAll ? 'partial' : 'timeout' }
  }
}

/**
 * Cache the walking properties that `movements.getBlock` writes on a block object. Without the cache they are computed a
 * hundred times per node. They stay valid as long as the block object, since a position whose state changes gets a new
 * object. Do not change the sets of block types in `movements` after this call.
 */
function rememberBlocks (movements, bot, unknownAt) {
  const { getBlock } = movements
  movements.getBlock = (place, dx, dy, dz) => {
    if (!place || !Number.isInteger(place.y)) return getBlock.call(movements, place, dx, dy, dz)
    const x = Math.floor(place.x + dx)
    const y = place.y + dy
    const z = Math.floor(place.z + dz)
    const unknown = unknownAt?.(x, y, z, dy < 0)
    if (unknown !== undefined) return unknown
    if (y < bot.world.bottom) return NOTHING
    const block = bot.world.blockIn(x, y, z)
    if (block === null || block.notedBy !== movements) return noted(place, dx, dy, dz)
    // Reset the height: a search raises a block on which it would place another one.
    block.height = block.top
    return block
  }
  function noted (place, dx, dy, dz) {
    const block = getBlock.call(movements, place, dx, dy, dz)
    if (block.position === undefined) return block
    block.notedBy = movements
    block.top = block.height
    return block
  }
}

/** Skip the entity lookup for positions without entities, which avoids building a text key for each of them. */
function rememberEntities (movements) {
  const { updateCollisionIndex, clearCollisionIndex, getNumEntitiesAt } = movements
  let taken = new Set()
  movements.updateCollisionIndex = () => {
    updateCollisionIndex.call(movements)
    taken = new Set(Object.keys(movements.entityIntersections).map(key => hash(...key.split(',').map(Number))))
  }
  movements.clearCollisionIndex = () => {
    clearCollisionIndex.call(movements)
    taken = new Set()
  }
  movements.getNumEntitiesAt = (place, dx, dy, dz) => {
    if (!place || !taken.has(hash(place.x + dx, place.y + dy, place.z + dz))) return 0
    return getNumEntitiesAt.call(movements, place, dx, dy, dz)
  }
}

// Two positions may have the same hash, which only costs a lookup; no position is missed.
function hash (x, y, z) {
  return (x * 961 + y * 31 + z) | 0
}

module.exports = { chargePathfinder }
