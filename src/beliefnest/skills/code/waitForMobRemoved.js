'use strict'
const { distance, show } = require('./lib/arguments')
const { until } = require('./lib/waiting')

const TICKS_PER_SECOND = 20

module.exports = {
  name: 'waitForMobRemoved',
  description: 'Wait until an entity is gone; fails after timeout seconds (300 if left out).',
  fails: 'the entity is still there at the end',
  parameters: [
    { name: 'entity', type: 'Entity', description: 'an entity, for instance from bot.nearestEntity()' },
    { name: 'timeout', type: 'number', description: 'seconds' }
  ],
  example: 'await waitForMobRemoved(bot, bot.nearestEntity(), 10)',
  async run (context, entity, timeout = 300) {
    const { bot, fail } = context
    if (!Number.isInteger(entity?.id)) fail(`entity must be an entity, like bot.nearestEntity(); it is ${show(entity)}`)
    const seconds = distance(context, 'timeout', timeout)
    const gone = await until(context, () => !bot.entities[entity.id], seconds * TICKS_PER_SECOND)
    if (!gone) fail(`${entity.name ?? 'the entity'} is still there after ${seconds} seconds.`)
  }
}
