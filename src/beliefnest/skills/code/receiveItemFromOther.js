'use strict'
const { count: checkCount, item: checkItem, otherAgent } = require('./lib/arguments')
const { countOf } = require('./lib/inventory')
const { until } = require('./lib/waiting')

const PATIENCE_TICKS = 600

module.exports = {
  name: 'receiveItemFromOther',
  description: 'Wait, for at most 30 seconds, until another agent has given you the items with giveItemToOther.',
  fails: 'fewer items came within 30 seconds (the error says how many)',
  parameters: [
    { name: 'otherName', type: 'string', description: 'name of the agent that gives the items', aim: 'uses' },
    { name: 'item', type: 'string', description: 'name of the item' },
    { name: 'num', type: 'number', description: 'how many; 1 if left out' }
  ],
  example: 'await receiveItemFromOther(bot, "sally", "diamond", 1)',
  async run (context, otherName, itemName, num = 1) {
    const { bot, fail } = context
    const other = otherAgent(context, 'otherName', otherName)
    const item = checkItem(context, 'item', itemName)
    const wanted = checkCount(context, 'num', num)
    const before = countOf(bot, item)
    const received = () => countOf(bot, item) - before
    const done = await until(context, () => received() >= wanted, PATIENCE_TICKS)
    if (!done) fail(`${received()} of ${wanted} ${item.name} came from ${other} within ${PATIENCE_TICKS} ticks. Ask ${other} to give it at the same time.`)
  }
}
