'use strict'
/**
 * Going through doors and gates, which the pathfinder takes for walls: when it finds no way, the bot goes
 * through the door that lies best, and looks for the way again. Iron doors are gone through where they are open.
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

/** Opens or shuts the door at a position, if it is not so and moves by hand; @returns {Promise<boolean>} whether it is so */
async function bring (context, position, open) {
  const { bot } = context
  const isSo = () => bot.blockAt(position).getProperties().open === open
  if (isSo() || !byHand(bot.blockAt(position))) return isSo()
  await bot.activateBlock(bot.blockAt(position))
  await answered(context)
  return isSo()
}

/**
 * Whether a way leads to a goal. A search takes as long as a tick of thinking and no fuel, so that walks of one bot that
 * search at the same time take turns, one search a tick.
 */
function isReachable ({ bot, inTurn }, goal) {
  return inTurn(() => bot.pathfinder.getPathTo(bot.pathfinder.movements, goal).status === 'success')
}

async function passDoor (context, position, { closeDoors }) {
  const { bot, goals } = context
  const sides = sidesOf(bot.blockAt(position))
  for (const [near, far] of [sides, [...sides].reverse()]) {
    const goal = new goals.GoalBlock(near.x, near.y, near.z)
    if (!await isReachable(context, goal)) continue
    await bot.pathfinder.goto(goal)
    if (!await bring(context, position, true) || !await stepThrough(context, far, ARRIVED)) continue
    if (closeDoors) {
      // Who still stands in the doorway would be stuck in the door.
      await stepThrough(context, far, CLEAR)
      await bring(context, position, false)
    }
    return true
  }
  return false
}

/**
 * Goes through one door that was not tried before.
 * @param {Set<string>} tried positions of doors, added to
 * @param {{openDoors: boolean, closeDoors: boolean}} doors whether to open shut ones, and to shut those gone through
 * @returns {Promise<boolean>} whether it went through one
 */
async function passOneDoor (context, target, tried, doors) {
  for (const position of doorsBy(context.bot, target, doors)) {
    if (tried.has(String(position))) continue
    tried.add(String(position))
    if (await passDoor(context, position, doors)) return true
  }
  return false
}

module.exports = { passOneDoor }
