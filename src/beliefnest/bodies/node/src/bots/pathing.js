'use strict'
/** Path finding whose limits are numbers of nodes, so that a slow machine finds the same ways. */

// Time that looking at one node of a path counts as. With the pathfinder's 40 ms a tick that is
// 427 nodes a tick, and 53,000 until it gives up. Sums of it are exact, at any time of day.
const NODE_MS = 3 / 32

/**
 * Limits the bot's searches for paths by the nodes they look at, and keeps it from changing the world on its
 * way: agents walk around walls, they do not dig through them. `bot.pathfinder.reset()` undoes what
 * a program has set.
 *
 * @param {object} bot
 * @param {{charge?: (ms: number) => void}} clock pays for each node; without `charge` time is real, and nodes are counted
 * @param {(x: number, y: number, z: number, isBelow: boolean) => object | undefined} [unknownAt] what to make of a block
 *   that the bot does not know; undefined where it knows
 */
function chargePathfinder (bot, clock, unknownAt) {
  const setMovements = bot.pathfinder.setMovements
  const charged = movements => {
    const getNeighbors = movements.getNeighbors
    movements.getNeighbors = node => {
      clock.charge?.(NODE_MS)
      return getNeighbors.call(movements, node)
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
    const known = Object.hasOwn(movements, 'getNeighbors')
    setMovements(known ? movements : charged(movements))
  }
  const { thinkTimeout, tickTimeout, searchRadius } = bot.pathfinder
  bot.pathfinder.reset = () => {
    Object.assign(bot.pathfinder, { thinkTimeout, tickTimeout, searchRadius })
    if (bot.pathfinder.movements !== standard) setMovements(standard)
  }
}

/**
 * Let searches end after as many nodes as their limits of time stand for. A search that ends a tick without a
 * path counts as one without a way, so that a process that gets no processor for 40 ms would lose its way.
 */
function countNodes (pathfinder) {
  const { getPathFromTo } = pathfinder
  pathfinder.getPathFromTo = function * (movements, from, goal, options = {}) {
    const { timeout = pathfinder.thinkTimeout, tickTimeout = pathfinder.tickTimeout } = options
    // A search that may take no time at all has looked at nothing yet.
    const results = getPathFromTo(movements, from, goal, { ...options, timeout: Infinity, tickTimeout: -1 })
    limit(results.next().value.astarContext, nodesIn(tickTimeout), nodesIn(timeout))
    yield * results
  }
}

/** A search goes on until more time has passed than it may take. */
const nodesIn = milliseconds => Math.max(Math.floor(milliseconds / NODE_MS) + 1, 1)

/** Limits an A* search to so many nodes each time it is continued, and in all. */
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
 * Movements note on a block what it is to a walker, anew each time it is asked for, a hundred times a node. What they
 * noted holds as long as the block: a place whose state changes gets another object. Their sets of
 * kinds of blocks must not be changed any more.
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
    const block = bot.world.blockIn(x, y, z)
    if (block === null || block.notedBy !== movements) return noted(place, dx, dy, dz)
    // A search raises blocks it would put another one on.
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

/** Most places have no entity, and need not be made a text of in order to find none. */
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

// Two places may have the same; none has two.
function hash (x, y, z) {
  return (x * 961 + y * 31 + z) | 0
}

module.exports = { chargePathfinder }
