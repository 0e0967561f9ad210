'use strict'
/**
 * Going through doors and gates, which the pathfinder takes for walls: when it finds no way, one through doors is looked for
 * before the bot goes anywhere. Iron doors are gone through where they are open.
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

/** The two places beside a door, in its passage. */
function sidesOf (block) {
  const [x, z] = ['north', 'south'].includes(block.getProperties().facing) ? [0, 1] : [1, 0]
  return [block.position.offset(x, 0, z), block.position.offset(-x, 0, -z)]
}

/** Doors that may be gone through, those that lie best first. */
function doorsBy (bot, target, { openDoors }) {
  const length = door => door.distanceTo(bot.entity.position) + door.distanceTo(target)
  const passable = block => DOORWAY.test(block.name) && ((openDoors && byHand(block)) || block.getProperties().open)
  return bot.findBlocks({
    matching: block => passable(block) && block.getProperties().half !== 'upper', maxDistance: FAR, count: MOST
  }).sort((a, b) => length(a) - length(b) || a.x - b.x || a.z - b.z)
}

async function stepThrough (context, far, near) {
  const { bot } = context
  const centre = far.offset(0.5, 0, 0.5)
  await bot.lookAt(centre.offset(0, bot.entity.eyeHeight, 0), true)
  return stepUntil(context, () => bot.entity.position.xzDistanceTo(centre) < near, STEP_TICKS)
}

/** Open or shuts the door at a position, if it is not so and moves by hand; @returns {Promise<boolean>} true if it is so */
async function bring (context, position, open) {
  const { bot } = context
  const isSo = () => bot.blockAt(position).getProperties().open === open
  if (isSo() || !byHand(bot.blockAt(position))) return isSo()
  await bot.activateBlock(bot.blockAt(position))
  await answered(context)
  return isSo()
}

/**
 * Whether a way leads from a place to a goal. A search takes as long as a tick of thinking and no fuel, so that walks of one
 * bot that search at the same time take turns, one search a tick.
 */
function leads ({ bot, inTurn }, from, goal) {
  const { movements, thinkTimeout: timeout } = bot.pathfinder
  return inTurn(() => bot.pathfinder.getPathFromTo(movements, from, goal, { timeout }).next().value.result.status === 'success')
}

const middleOf = place => place.offset(0.5, 0, 0.5)
const legKey = ({ door, near }) => `${door} from ${near}`

/** The doors that can be got to from a place, each as a leg of a way: what side it is gone to from, and where it leads. */
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
 * The legs of a way through doors: from the place that lies best on, and into a doorway only where the goal is met in no other place.
 * @param {Set<string>} tried legs that are not to be in it
 * @returns {Promise<object[] | null>} null if there is none
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
    // Who still stands in the doorway would be stuck in the door.
    await stepThrough(context, far, CLEAR)
    await bring(context, door, false)
  }
  return true
}

/**
 * Go through the doors that lie between the bot and a goal, each at most once from each side.
 * @param {object} goal of the pathfinder
 * @param {Vec3} target near which the goal is
 * @param {Set<string>} tried legs that were gone already, added to
 * @param {{openDoors: boolean, closeDoors: boolean}} doors whether to open shut ones, and to shut those gone through
 * @returns {Promise<boolean>} true if it went through any; false: no way through doors is known
 */
async function passDoors (context, goal, target, tried, doors) {
  const legs = await planThrough(context, goal, target, tried, doors)
  for (const leg of legs ?? []) {
    tried.add(legKey(leg))
    if (!await pass(context, leg, doors)) break
  }
  return legs !== null
}

module.exports = { passDoors }
