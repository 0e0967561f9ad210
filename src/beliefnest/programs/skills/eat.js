'use strict'
const { item: checkItem } = require('./lib/arguments')
const { countOf, hold } = require('./lib/inventory')
const { ticks } = require('./lib/waiting')

const FULL = 20

module.exports = {
  name: 'eat',
  signature: 'eat(bot, name)',
  description: 'Eat one piece of food from your inventory. Works only when you are not full.',
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'name', type: 'string', description: 'name of the food' }
  ],
  example: 'await eat(bot, "bread")',
  async run (context, name) {
    const { bot, fail } = context
    const item = checkItem(context, 'name', name)
    if (!bot.registry.foodsByName[item.name]) fail(`${name} is no food. Eat something like bread or an apple.`)
    await hold(context, item)
    if (bot.food >= FULL) fail('you are not hungry: your food level is full.')
    const before = countOf(bot, item)
    await bot.consume()
    await ticks(1)
    if (countOf(bot, item) >= before) fail(`${name} was not eaten. Try again.`)
  }
}
