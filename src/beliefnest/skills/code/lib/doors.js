'use strict'
/**
 * Walking through doors and gates, which the pathfinder treats as walls. When the pathfinder finds no path, or
 * none in a number of nodes, this module plans a path through doors before the bot moves. It uses iron doors only where
 * they are open.
 */
const { answered } = require('./answers')
const { stepUntil } = require('./stepping')

const DOORWAY = /(_door|_fence_gate)$/
const FAR = 48
const MOST = 16
const STEP_TICKS = 40
const ARRIVED = 0.4
const CLEAR = 0.15

const byHand = block => !block.name.startsWith('iron_')

/** Return the two positions next to a door, in the direction of its passage. */
function sidesOf (block) {
  const [x, z] = ['north', 'south'].includes(block.getProperties().facing) ? [0, 1] : [1, 0]
  return [block.position.offset(x, 0, z), block.position.offset(-x, 0, -z)]
}

/** Return the doors that the bot may walk through, those with the shortest detour first. */
function doorsBy (bot, target, { openDoors }) {
  const length = door => door.distanceTo(bot.entity.position) + door.distanceTo(target)
  const passable = block => DOORWAY.test(block.name) && ((openDoors && byHand(block)) || block.getProperties().open)
  return bot.findBlocks({
    matching: block => passable(block) && block.getProperties().half !== 'upper', maxDistance: FAR, count: MOST
  }).sort((a, b) => length(a) - length(b) || a.x - b.x || a.z - b.z)
}

/** Return true if the bot knows doors that it may walk through. */
const knowsDoors = (bot, target, doors) => doorsBy(bot, target, doors).length > 0

async function stepThrough (context, far, near) {
  const { bot } = context
  const centre = far.offset(0.5, 0, 0.5)
  await bot.lookAt(centre.offset(0, bot.entity.eyeHeight, 0), true)
  return stepUntil(context, () => bot.entity.position.xzDistanceTo(centre) < near, STEP_TICKS)
}

/**
 * Open or shut the door at a position, if needed and if it can be moved by hand.
 * @returns {Promise<boolean>} true if the door is in the wanted state afterwards
 */
async function bring (context, position, open) {
  const { bot } = context
  const isSo = () => bot.blockAt(position).getProperties().open === open
  if (isSo() || !byHand(bot.blockAt(position))) return isSo()
  await bot.activateBlock(bot.blockAt(position))
  await answered(context)
  return isSo()
}

/**
 * Return true if a path leads from a position to a goal. A search costs one tick of thinking time and no fuel;
 * therefore concurrent searches of one bot take turns, one search a tick.
 */
function leads ({ bot, inTurn }, from, goal) {
  const { movements, thinkTimeout: timeout } = bot.pathfinder
  return inTurn(() => bot.pathfinder.getPathFromTo(movements, from, goal, { timeout }).next().value.result.status === 'success')
}

const middleOf = place => place.offset(0.5, 0, 0.5)
const legKey = ({ door, near }) => `${door} from ${near}`

/**
 * Return the doors that can be reached from a position, each as a leg: the side from which the bot enters and the side
 * to which the door leads.
 */
async function legsFrom (context, from, doors, tried) {
  const legs = []
  for (const door of doors) {
    const sides = sidesOf(context.bot.blockAt(door))
    for (const [near, far] of [sides, [...sides].reverse()]) {
      const leg = { door, near, far }
      if (tried.has(legKey(leg)) || !await leads(context, from, new context.goals.GoalBlock(near.x, near.y, near.z))) continue
      legs.push(leg)
      break
    }
  }
  return legs
}

/**
 * Return the legs of a path through doors. This is a best-first search: it expands the position with the smallest path
 * length plus distance to the target. A leg ends in a doorway only if no other position meets the goal.
 * @param {Set<string>} tried legs that the plan must not contain
 * @returns {Promise<object[] | null>} null if there is no such path
 */
async function planThrough (context, goal, target, tried, doors) {
  let left = doorsBy(context.bot, target, doors)
  let places = [{ from: context.bot.entity.position, length: 0, legs: [] }]
  let intoDoorway = null
  while (places.length > 0) {
    const best = places.reduce((a, b) => b.length + b.from.distanceTo(target) < a.length + a.from.distanceTo(target) ? b : a)
    places = places.filter(place => place !== best)
    if (best.legs.length > 0 && await leads(context, best.from, goal)) return best.legs
    const legs = await legsFrom(context, best.from, left, tried)
    left = left.filter(door => legs.every(leg => leg.door !== door))
    const ending = legs.find(({ door }) => goal.isEnd(door))
    if (ending !== undefined) intoDoorway ??= [...best.legs, { ...ending, far: ending.door, isLast: true }]
    places.push(...legs.map(leg => {
      const from = middleOf(leg.far)
      return { from, length: best.length + best.from.distanceTo(from), legs: [...best.legs, leg] }
    }))
  }
  return intoDoorway
}

async function pass (context, { door, near, far, isLast }, { closeDoors }) {
  const { bot, goals } = context
  const beside = new goals.GoalBlock(near.x, near.y, near.z)
  if (!await leads(context, bot.entity.position, beside)) return false
  await bot.pathfinder.goto(beside)
  if (!await bring(context, door, true) || !await stepThrough(context, far, isLast ? CLEAR : ARRIVED)) return false
  if (closeDoors && !isLast) {
    // A bot that still stands in the doorway would be stuck in the shut door.
    await stepThrough(context, far, CLEAR)
    await bring(context, door, false)
  }
  return true
}

/**
 * Walk through the doors between the bot and a goal, through each door at most once from each side.
 * @param {object} goal of the pathfinder
 * @param {Vec3} target position near the goal
 * @param {Set<string>} tried legs that were walked already; this function adds to it
 * @param {{openDoors: boolean, closeDoors: boolean}} doors whether to open shut doors, and whether to shut doors
 *   afterwards
 * @returns {Promise<boolean>} true if a path through doors was found, false if none is known
 */
async function passDoors (context, goal, target, tried, doors) {
  const legs = await planThrough(context, goal, target, tried, doors)
  for (const leg of legs ?? []) {
    tried.add(legKey(leg))
    if (!await pass(context, leg, doors)) break
  }
  return legs !== null
}

module.exports = { knowsDoors, passDoors }
