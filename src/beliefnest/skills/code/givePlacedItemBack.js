'use strict'
const { blockPosition, item: checkItem } = require('./lib/arguments')
const { mine } = require('./lib/mining')
const { countOf } = require('./lib/inventory')

module.exports = {
  name: 'givePlacedItemBack',
  description: 'Take back a block that was placed, such as a crafting table: mine it and pick it up.',
  fails: 'there is no path on foot; another block is there; you have no suitable tool; you did not get the item back',
  parameters: [
    { name: 'name', type: 'string', description: 'name of the placed item' },
    { name: 'position', type: 'Vec3', description: 'where it was placed', aim: 'uses' }
  ],
  example: 'await givePlacedItemBack(bot, "crafting_table", new Vec3(4, -51, 2))',
  async run (context, name, position) {
    const item = checkItem(context, 'name', name)
    const before = countOf(context.bot, item)
    await mine(context, blockPosition(context, 'position', position), name)
    if (countOf(context.bot, item) <= before) {
      context.fail(`${name} was removed, but it did not come back to the inventory. Blocks like this give something else, or nothing.`)
    }
  }
}
