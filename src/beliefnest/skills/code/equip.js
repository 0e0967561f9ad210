'use strict'
const { item: checkItem, show } = require('./lib/arguments')
const { stackOf } = require('./lib/inventory')
const { answered } = require('./lib/answers')

const PLACES = ['hand', 'off-hand', 'head', 'torso', 'legs', 'feet']

module.exports = {
  name: 'equip',
  description: 'Take an item from your inventory in hand, or put it on: hand, off-hand, head, torso, legs, feet.',
  fails: 'you do not carry the item; it does not fit the destination',
  parameters: [
    { name: 'name', type: 'string', description: 'name of the item' },
    { name: 'destination', type: 'string', description: 'where to', default: '"hand"' }
  ],
  example: 'await equip(bot, "iron_chestplate", "torso")',
  async run (context, name, destination = 'hand') {
    const { bot, fail } = context
    const item = checkItem(context, 'name', name)
    if (!PLACES.includes(destination)) fail(`destination must be one of ${PLACES.join(', ')}; it is ${show(destination)}`)
    const slot = () => bot.getEquipmentDestSlot(destination)
    if (bot.inventory.slots[slot()]?.type === item.id) return
    await bot.equip(stackOf(context, item), destination)
    await answered(context)
    if (bot.inventory.slots[slot()]?.type === item.id) return
    const { inventory } = bot
    if (inventory.selectedItem) await bot.putSelectedItemRange(inventory.inventoryStart, inventory.inventoryEnd, inventory, null)
    fail(`${name} does not go there: ${destination} takes something else.`)
  }
}
