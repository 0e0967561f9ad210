'use strict'
const { count: checkCount, distance } = require('./lib/arguments')
const { bodyOf } = require('./lib/others')
const { settle } = require('./lib/walking')
const { ticks } = require('./lib/waiting')

const SLACK = 1

/**
 * Make a follow goal search for a new path as soon as the entity changes its block. By itself the goal waits until the
 * entity has moved `range` blocks further.
 */
function closely (goal) {
  goal.hasChanged = () => {
    const { x, y, z } = goal.entity.position.floored()
    if (x === goal.x && y === goal.y && z === goal.z) return false
    Object.assign(goal, { x, y, z })
    return true
  }
  return goal
}

module.exports = {
  name: 'follow',
  description: 'Follow another agent for a number of ticks, staying within dist blocks. Fails if it is not near at the end.',
  fails: 'the other agent is absent, not visible, or not near at the end',
  parameters: [
    { name: 'otherName', type: 'string', description: 'name of the agent to follow', aim: 'walks' },
    { name: 'number', type: 'number', description: 'how many ticks', default: '100' },
    { name: 'dist', type: 'number', description: 'how near, in blocks', default: '2' }
  ],
  example: 'await follow(bot, "anne", 200)',
  async run (context, otherName, number = 100, dist = 2) {
    const { bot, goals, fail } = context
    const body = bodyOf(context, 'otherName', otherName)
    const duration = checkCount(context, 'number', number)
    const near = distance(context, 'dist', dist)
    bot.pathfinder.setGoal(closely(new goals.GoalFollow(body, near)), true)
    await ticks(context, duration)
    bot.pathfinder.setGoal(null)
    await settle(context)
    // Count in whole blocks, as the pathfinder does.
    const away = bot.entity.position.floored().distanceTo(body.position.floored())
    if (away > near + SLACK) fail(`${otherName} is ${away.toFixed(1)} blocks away after ${duration} ticks. Follow longer; if that does not help, there is no way on foot.`)
  }
}
