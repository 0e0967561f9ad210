'use strict'
const { blockPosition, items: checkItems, show } = require('./lib/arguments')
const { withContainer, move } = require('./lib/chests')

function shortfall (position, { item, count, there, room, moved }) {
  const reason = there < count ? `the inventory holds ${there}` : `the chest has room for ${room}`
  const cause = Math.min(there, room) < count ? reason : 'somebody else put something in at the same time'
  return `${count} ${item.name} to be put into the chest at ${show(position)}, ${cause}; ${moved} put in`
}

module.exports = {
  name: 'depositItemIntoChest',
  scripted: true,
  description: 'Go to the chest, open it, put the items in, close it. If you have fewer items, put them in and fail; the error names the missing ones.',
  fails: 'there is no path on foot; there is no container; its lid is blocked; you have fewer items, or it has less room (as many as possible are put in); somebody closed it meanwhile',
  parameters: [
    { name: 'chestPosition', type: 'Vec3', description: 'position of a chest or barrel', aim: 'uses', action: ['container'] },
    { name: 'items', type: '{[name: string]: number}', description: 'how many of which items', action: ['item', 'count'] }
  ],
  example: 'await depositItemIntoChest(bot, new Vec3(-2, -51, -4), {diamond: 1})',
  check: (context, chestPosition, items) => [blockPosition(context, 'chestPosition', chestPosition), checkItems(context, 'items', items)],
  async run (context, position, wanted) {
    const outcomes = await withContainer(context, position, window => move(context, window, 'inventory', 'chest', wanted))
    const missing = outcomes.filter(({ moved, count }) => moved < count).map(outcome => shortfall(position, outcome))
    if (missing.length) context.fail(`${missing.join('; ')}. Get more first, or put in less.`)
  }
}
