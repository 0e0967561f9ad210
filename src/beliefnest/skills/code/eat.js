'use strict'
const { item: checkItem } = require('./lib/arguments')
const { countOf, hold } = require('./lib/inventory')
const { until } = require('./lib/waiting')

const FULL = 20
const EATING_TICKS = 60

module.exports = {
  name: 'eat',
  description: 'Eat one piece of food from your inventory. Works only when you are not full.',
  fails: 'the item is not food, or you do not carry it; you are not hungry; you did not finish eating',
  parameters: [
    { name: 'name', type: 'string', description: 'name of the food' }
  ],
  example: 'await eat(bot, "bread")',
  async run (context, name) {
    const { bot, fail } = context
    const item = checkItem(context, 'name', name)
    if (!Object.hasOwn(bot.registry.foodsByName, item.name)) fail(`${name} is no food. Eat something like bread or an apple.`)
    await hold(context, item)
    if (bot.food >= FULL) fail('you are not hungry: your food level is full.')
    const before = countOf(bot, item)
    bot.activateItem()
    const eaten = await until(context, () => countOf(bot, item) < before, EATING_TICKS)
    if (!eaten) fail(`${name} was not eaten. Try again.`)
  }
}
