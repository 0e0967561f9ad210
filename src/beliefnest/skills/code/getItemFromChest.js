'use strict'
const { blockPosition, items: checkItems, show } = require('./lib/arguments')
const { withContainer, move } = require('./lib/chests')

function shortfall (position, { item, count, there, room, moved }) {
  const reason = there < count ? `it holds ${there}` : `there was room for ${room} in the inventory`
  const cause = Math.min(there, room) < count ? reason : 'somebody else took from it at the same time'
  return `${count} ${item.name} asked for from the chest at ${show(position)}, ${cause}; ${moved} taken`
}

module.exports = {
  name: 'getItemFromChest',
  scripted: true,
  description: 'Go to the chest, open it, take the items, close it. If there are fewer items, take them and fail; the error names the missing ones.',
  fails: 'there is no path on foot; there is no container; its lid is blocked; it holds fewer items (those are taken); somebody closed it meanwhile',
  parameters: [
    { name: 'chestPosition', type: 'Vec3', description: 'position of a chest or barrel', aim: 'uses', action: ['container'] },
    { name: 'items', type: '{[name: string]: number}', description: 'how many of which items', action: ['item', 'count'] }
  ],
  example: 'await getItemFromChest(bot, new Vec3(2, -51, -4), {diamond: 1})',
  check: (context, chestPosition, items) => [blockPosition(context, 'chestPosition', chestPosition), checkItems(context, 'items', items)],
  async run (context, position, wanted) {
    const outcomes = await withContainer(context, position, window => move(context, window, 'chest', 'inventory', wanted))
    const missing = outcomes.filter(({ moved, count }) => moved < count).map(outcome => shortfall(position, outcome))
    if (missing.length) context.fail(`${missing.join('; ')}. Ask for what is there, or look elsewhere.`)
  }
}
