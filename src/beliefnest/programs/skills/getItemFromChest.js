'use strict'
const { blockPosition, items: checkItems, show } = require('./lib/arguments')
const { withContainer, move } = require('./lib/chests')

function shortfall (position, item, wanted, { there, room, moved }) {
  const found = there < wanted ? `it holds ${there}` : `there was room for ${room} in the inventory`
  return `${wanted} ${item.name} asked for from the chest at ${show(position)}, ${found}; ${moved} taken`
}

module.exports = {
  name: 'getItemFromChest',
  signature: 'getItemFromChest(bot, chestPosition, items)',
  description: 'Go to the chest, open it, take the items, close it. Takes what is there and fails, naming what is missing, if that is less.',
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'chestPosition', type: 'Vec3', description: 'position of a chest or barrel' },
    { name: 'items', type: '{[name: string]: number}', description: 'how many of which items' }
  ],
  example: 'await getItemFromChest(bot, new Vec3(2, -51, -4), {diamond: 1})',
  async run (context, chestPosition, items) {
    const position = blockPosition(context, 'chestPosition', chestPosition)
    const wanted = checkItems(context, 'items', items)
    const missing = []
    await withContainer(context, position, async window => {
      for (const [item, count] of wanted) {
        const outcome = await move(context, window, 'chest', 'inventory', item, count)
        if (outcome.moved < count) missing.push(shortfall(position, item, count, outcome))
      }
    })
    if (missing.length) context.fail(`${missing.join('; ')}. Ask for what is there, or look elsewhere.`)
  }
}
