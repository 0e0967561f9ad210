'use strict'
/** Walking. Every walk ends at its goal, or in an error that says how far away the bot is. */
const { until } = require('./waiting')
const { show } = require('./arguments')
const { knowsDoors, passDoors } = require('./doors')
const { EYE_HEIGHT, hindranceOf, sees, shapesOf } = require('./sight')
const { stepUntil } = require('./stepping')

const REACH = 4
const STILL = 0.01
const SETTLE_TICKS = 10
const MIDDLE = 0.15
/** Height below which a block is a layer on the floor, such as a carpet. */
const LAYER = 0.1
const STEP_TICKS = 40
/** Number of times that the pathfinder may get stuck at one place before its path is given up. */
const MOST_STUCK = 2
/** Number of nodes after which a search is broken off if the bot knows doors: they cost the same in a box of any size. */
const MOST_NODES = 10_000

const ANY_DOOR = { openDoors: true, closeDoors: false }

const REASONS = {
  NoPath: 'there is no way to it on foot',
  Timeout: 'no way to it was found in time',
  GoalChanged: 'the walk was given up for another goal',
  PathStopped: 'the walk was stopped'
}

const noPath = () => Object.assign(new Error('no way'), { name: 'NoPath' })
const rounded = ({ x, y, z }) => show({ x: Math.round(x * 10) / 10, y: Math.round(y * 10) / 10, z: Math.round(z * 10) / 10 })
const centreOf = block => block.offset(0.5, 0.5, 0.5)

/** Stop moving and wait until the bot stands; otherwise the speed of its last step would carry it on. */
async function settle (context) {
  const { bot } = context
  bot.clearControlStates()
  const { velocity } = bot.entity
  await until(context, () => Math.abs(velocity.x) < STILL && Math.abs(velocity.z) < STILL && bot.entity.onGround, SETTLE_TICKS)
}

/**
 * Search once for a path and walk along it.
 * @param {object} context of the skill
 * @param {object} goal goal of the pathfinder
 * @param {() => boolean} breaksOff asked once, after MOST_NODES nodes of a search; true to break the search off
 * @returns {Promise<Error | null>} the reason why the walk ended early; null if it did not
 */
async function attempt (context, goal, breaksOff) {
  const { pathfinder } = context.bot
  const giveUp = () => pathfinder.setGoal(null)
  const stuck = watchStuck(context, giveUp)
  const search = watchSearch(context, breaksOff, giveUp)
  try {
    await pathfinder.goto(goal)
    return null
  } catch (error) {
    if (!(error.name in REASONS)) throw error
    if (search.isBrokenOff()) return Object.assign(noPath(), { isBrokenOff: true })
    return stuck.isStuck() ? Object.assign(noPath(), { isStuck: true }) : error
  } finally {
    stuck.end()
    search.end()
    await settle(context)
  }
}

/** Call a function when the pathfinder gets stuck at one place again and again: it would try the same path forever. */
function watchStuck (context, giveUp) {
  let [place, times] = [null, 0]
  const end = context.listen('path_reset', reason => {
    if (reason !== 'stuck') return
    const here = context.bot.entity.position.floored()
    times = place?.equals(here) ? times + 1 : 1
    place = here
    if (times === MOST_STUCK) giveUp()
  })
  return { end, isStuck: () => times >= MOST_STUCK }
}

/** Call a function when a search has taken MOST_NODES nodes and `breaksOff()` is true. */
function watchSearch (context, breaksOff, giveUp) {
  let [isLong, isBrokenOff] = [false, false]
  const ends = [
    context.listen('path_update', ({ status, visitedNodes }) => {
      if (isLong || status !== 'partial' || visitedNodes <= MOST_NODES) return
      isLong = true
      isBrokenOff = breaksOff()
    }),
    // Not earlier: the pathfinder takes up the path of an update after its listeners.
    context.listen('physicsTick', () => { if (isBrokenOff && context.bot.pathfinder.goal !== null) giveUp() })
  ]
  return { end: () => ends.forEach(end => end()), isBrokenOff: () => isBrokenOff }
}

/**
 * Walk to a goal, through doors if needed; fail if the bot does not arrive. A search that takes too long is broken off
 * for a way through doors, and made in full only if there is none.
 * @param {object} context of the skill
 * @param {object} goal goal of the pathfinder
 * @param {() => boolean} arrived true if the bot's true position meets the goal
 * @param {Vec3} target position for the message
 * @param {string} what name of the target for the message, e.g. "the chest"
 * @param {{openDoors: boolean, closeDoors: boolean}} doors whether to open shut doors on the way, and whether to shut
 *   doors afterwards
 */
async function walk (context, goal, arrived, target, what, doors = ANY_DOOR) {
  const { bot, fail } = context
  const tried = new Set()
  const centred = new Set()
  let isFull = false
  let fault = null
  while (!arrived()) {
    fault = await attempt(context, goal, () => !isFull && knowsDoors(bot, target, doors))
    if (arrived()) return
    const here = `${bot.entity.position.floored()}`
    if (fault?.isStuck && !centred.has(here)) {
      // At the edge of its block the bot may touch what it would pass from the middle.
      centred.add(here)
      await stepToMiddle(context, () => false)
      continue
    }
    const walled = fault === null || fault.name === 'NoPath'
    const hasPassed = walled && await passDoors(context, goal, target, tried, doors)
    if (!hasPassed && !fault?.isBrokenOff) break
    isFull = !hasPassed
  }
  if (arrived()) return
  const near = bot.entity.position.distanceTo(target)
  fail(`could not reach ${what} at ${show(target)}: ${REASONS[fault?.name ?? 'NoPath']}; now at ${rounded(bot.entity.position)}, ` +
    `${near.toFixed(1)} blocks away. Go somewhere else, or clear the way first.`, fault ?? noPath())
}

/** Return true if a block is lower than a full one, and no thin layer: feet on it are in its own place. */
function isLow (block) {
  if (block?.boundingBox !== 'block') return false
  const top = Math.max(...block.shapes.map(shape => shape[4]))
  return top >= LAYER && top < 1
}

/** Walk to within `dist` blocks of a position. On a low block the bot is in its place, and in the one above it. */
async function walkNear (context, target, dist, what = 'the position', doors = ANY_DOOR) {
  const { bot, goals } = context
  const block = target.floored()
  const isNear = place => place.distanceTo(block) <= dist
  const goal = new goals.GoalNear(block.x, block.y, block.z, dist)
  goal.isEnd = node => isNear(node) || (isNear(node.offset(0, -1, 0)) && isLow(bot.blockAt(node.offset(0, -1, 0))))
  const arrived = () => {
    const feet = bot.entity.position.floored()
    return isNear(feet) || (isNear(feet.offset(0, 1, 0)) && isLow(bot.blockAt(feet)))
  }
  await walk(context, goal, arrived, target, what, doors)
}

const SAMPLES = [[0, 0, 0], [0.45, 0, 0], [-0.45, 0, 0], [0, 0.45, 0], [0, -0.45, 0], [0, 0, 0.45], [0, 0, -0.45]]

/**
 * Return true if a block can easily be used from an eye: it is near enough, and nothing obstructs its centre or one of
 * its sides. The raycast ignores the block that contains the eye, but the server does not; therefore `canSee` is
 * required as well.
 */
function canUse (bot, eye, block) {
  if (eye.distanceTo(centreOf(block)) > REACH) return false
  return SAMPLES.some(sample => {
    const way = centreOf(block).offset(...sample).minus(eye)
    const distance = way.norm()
    const hit = bot.world.raycast(eye, way.scaled(1 / distance), distance)
    return !hit || hit.position.equals(block)
  }) && canSee(bot, eye, block)
}

/** Return true if the server finds a free line from an eye to a block. */
const canSee = (bot, eye, block) => sees(shapesOf(bot), eye, block)

/** Return a pathfinder goal and a function `arrived`, both judged from the eye of a player at a position. */
function viewpoint ({ bot, goals }, block, accepts) {
  const goal = new goals.GoalNear(block.x, block.y, block.z, REACH)
  goal.isEnd = node => accepts(node, node.offset(0.5, EYE_HEIGHT, 0.5))
  const arrived = () => {
    const { position } = bot.entity
    // The last step may end anywhere in the target block.
    return accepts(position.floored(), position.offset(0, EYE_HEIGHT, 0)) || goal.isEnd(position.floored())
  }
  return { goal, arrived }
}

/** Return the middle of the block in which a bot stands. */
const middleOf = bot => bot.entity.position.floored().offset(0.5, 0, 0.5)

/** Go to the middle of the bot's block; stop earlier if `done()` is true. */
async function stepToMiddle (context, done) {
  const { bot } = context
  const middle = middleOf(bot)
  await bot.lookAt(middle.offset(0, EYE_HEIGHT, 0), true)
  await stepUntil(context, () => bot.entity.position.xzDistanceTo(middle) < MIDDLE || done(), STEP_TICKS)
  await settle(context)
}

/** Go to the middle of the bot's block if the server would accept the use of a block only from there. */
async function stepToView (context, block) {
  const { bot } = context
  if (hindranceOf(bot, block) === null || hindranceOf(bot, block, middleOf(bot)) !== null) return
  await stepToMiddle(context, () => hindranceOf(bot, block) === null)
}

/** Walk to where a block can be used. */
async function walkToUse (context, block, what) {
  const { goal, arrived } = viewpoint(context, block, (_, eye) => canUse(context.bot, eye, block))
  await walk(context, goal, arrived, block, what)
  await stepToView(context, block)
}

module.exports = { canSee, stepToView, walk, walkNear, walkToUse, viewpoint, canUse, settle, centreOf, rounded }
