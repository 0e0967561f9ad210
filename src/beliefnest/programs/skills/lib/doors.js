'use strict'
/**
 * Going through wooden doors and gates, which the pathfinder takes for walls: when it
 * finds no way, the bot goes through the door that lies best, and looks for the way again.
 */
const { answered } = require('./answers')
const { until } = require('./waiting')

const DOOR = /^(?!iron_).*(_door|_fence_gate)$/
const FAR = 48
const MOST = 16
const STEP_TICKS = 40

/** The two places beside a door, in its passage. */
function sidesOf (block) {
  const [x, z] = ['north', 'south'].includes(block.getProperties().facing) ? [0, 1] : [1, 0]
  return [block.position.offset(x, 0, z), block.position.offset(-x, 0, -z)]
}

function doorsBy (bot, target) {
  const length = door => door.distanceTo(bot.entity.position) + door.distanceTo(target)
  return bot.findBlocks({
    matching: block => DOOR.test(block.name) && block.getProperties().half !== 'upper', maxDistance: FAR, count: MOST
  }).sort((a, b) => length(a) - length(b) || a.x - b.x || a.z - b.z)
}

async function stepThrough (bot, far) {
  const centre = far.offset(0.5, 0, 0.5)
  await bot.lookAt(centre.offset(0, bot.entity.eyeHeight, 0), true)
  bot.setControlState('forward', true)
  const arrived = () => bot.entity.position.xzDistanceTo(centre) < 0.4
  await until(arrived, STEP_TICKS)
  bot.setControlState('forward', false)
  return arrived()
}

async function passDoor (context, position) {
  const { bot, goals } = context
  const block = () => bot.blockAt(position)
  const sides = sidesOf(block())
  for (const [near, far] of [sides, [...sides].reverse()]) {
    const goal = new goals.GoalBlock(near.x, near.y, near.z)
    const { status } = bot.pathfinder.getPathTo(bot.pathfinder.movements, goal)
    if (status !== 'success') continue
    await bot.pathfinder.goto(goal)
    if (!block().getProperties().open) {
      await bot.activateBlock(block())
      await answered(context)
    }
    if (!block().getProperties().open) continue
    if (await stepThrough(bot, far)) return true
  }
  return false
}

/**
 * Goes through one door that was not tried before.
 * @param {Set<string>} tried positions of doors, added to
 * @returns {Promise<boolean>} whether it went through one
 */
async function passOneDoor (context, target, tried) {
  for (const position of doorsBy(context.bot, target)) {
    if (tried.has(String(position))) continue
    tried.add(String(position))
    if (await passDoor(context, position)) return true
  }
  return false
}

module.exports = { passOneDoor }
