'use strict'
const { position: checkPosition, distance, show } = require('./lib/arguments')
const { rounded, settle, walk } = require('./lib/walking')

const STEP = 3

module.exports = {
  name: 'exploreUntil',
  description: 'Walk in a direction until callback returns a true value, and return that value; return null after maxDistance blocks.',
  fails: 'the direction has no length; the callback is not a function, or it throws an error',
  parameters: [
    { name: 'direction', type: 'Vec3', description: 'level direction, such as new Vec3(1, 0, 0)' },
    { name: 'maxDistance', type: 'number', description: 'how far to go at most, in blocks' },
    { name: 'callback', type: '() => any', description: 'function that is called every few steps, for instance () => bot.findBlock({matching: 1})' }
  ],
  example: 'const chest = await exploreUntil(bot, new Vec3(1, 0, 0), 20, () => bot.findBlock({matching: mcData.blocksByName.chest.id}))',
  async run (context, direction, maxDistance, callback) {
    const { bot, goals, fail } = context
    const way = checkPosition(context, 'direction', direction)
    const limit = distance(context, 'maxDistance', maxDistance)
    if (typeof callback !== 'function') fail(`callback must be a function, like () => bot.findBlock({matching: 1}); it is ${show(callback)}`)
    way.y = 0
    if (way.norm() === 0) fail(`direction must point somewhere on the level, like new Vec3(1, 0, 0); it is ${show(direction)}`)
    const start = bot.entity.position.clone()
    const ahead = way.normalize()
    for (let gone = 0; ; gone = Math.min(gone + STEP, limit)) {
      const point = start.plus(ahead.scaled(gone))
      const there = () => Math.hypot(bot.entity.position.x - point.x, bot.entity.position.z - point.z) <= 1.5
      await walk(context, new goals.GoalNearXZ(point.x, point.z, 1), there, point, `${rounded(point)}, further on`)
      const result = await callback()
      if (result) return result
      if (gone >= limit) break
    }
    await settle(context)
    return null
  }
}
