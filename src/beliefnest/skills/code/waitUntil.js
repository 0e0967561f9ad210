'use strict'
const { count, show } = require('./lib/arguments')
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'waitUntil',
  description: 'Call condition at every tick until it returns a true value, and return that value. Fails after a number of ticks.',
  fails: 'the condition did not become true in time, or it throws an error',
  parameters: [
    { name: 'condition', type: '() => any', description: 'function that returns a true value when the wait shall end' },
    { name: 'number', type: 'number', description: 'how many ticks at most', default: '200' }
  ],
  example: 'await waitUntil(bot, () => bot.players.anne.entity.position.z < 0)',
  async run (context, condition, number = 200) {
    if (typeof condition !== 'function') context.fail(`condition must be a function, like () => bot.health < 20; it is ${show(condition)}`)
    const limit = count(context, 'number', number)
    for (let passed = 0; ; passed++) {
      const result = await condition()
      if (result) return result
      if (passed >= limit) context.fail(`condition did not come true within ${limit} ticks.`)
      await ticks(context, 1)
    }
  }
}
