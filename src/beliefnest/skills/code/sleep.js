'use strict'
const { blockPosition, count: checkCount, show } = require('./lib/arguments')
const { walkToUse } = require('./lib/walking')
const { isUnseen, nameOf } = require('./lib/known')
const { answered } = require('./lib/answers')
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'sleep',
  description: 'Go to a bed, sleep in it for a number of ticks, and get up.',
  fails: 'there is no path on foot; there is no bed; somebody lies in it; nobody can sleep in it now',
  parameters: [
    { name: 'bedPosition', type: 'Vec3', description: 'position of the bed', aim: 'uses' },
    { name: 'number', type: 'number', description: 'how many ticks to sleep', default: '100' }
  ],
  example: 'await sleep(bot, new Vec3(4, -51, 2))',
  async run (context, bedPosition, number = 100) {
    const { bot, fail } = context
    const position = blockPosition(context, 'bedPosition', bedPosition)
    const duration = checkCount(context, 'number', number)
    const bed = () => {
      const block = bot.blockAt(position)
      if (!block || !bot.isABed(block)) fail(`there is no bed at ${show(position)}, but ${nameOf(bot, block)}.`)
      return block
    }
    if (!isUnseen(bot, position)) bed()
    await walkToUse(context, position, 'the bed')
    if (bed().getProperties().occupied) fail(`somebody lies in the bed at ${show(position)}. Wait, or find another one.`)
    await bot.activateBlock(bed())
    await answered(context)
    if (!bot.isSleeping) fail(`the bed at ${show(position)} cannot be slept in now.`)
    await ticks(context, duration)
    await bot.wake()
    await answered(context)
  }
}
