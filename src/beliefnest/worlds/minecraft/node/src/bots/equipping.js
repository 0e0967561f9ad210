'use strict'
/** Equipping items from the inventory. */

const HOTBAR_SIZE = 9

/**
 * Make a bot swap an item with the held one when it equips the item from outside a full hotbar. Mineflayer itself
 * cycles through the slots by a counter that no snapshot contains.
 */
function equipHeldSlot (bot) {
  const equip = bot.equip
  bot.equip = async (itemOrType, destination) => {
    const first = bot.QUICK_BAR_START
    const { inventory } = bot
    const item = typeof itemOrType === 'number' ? inventory.findInventoryItem(itemOrType) : itemOrType
    const full = !inventory.slots.slice(first, first + HOTBAR_SIZE).includes(null)
    const outside = item?.slot < first || item?.slot >= first + HOTBAR_SIZE
    if ((destination ?? 'hand') !== 'hand' || !full || !outside) return equip(itemOrType, destination)
    await bot.moveSlotItem(item.slot, first + bot.quickBarSlot)
  }
}

module.exports = { equipHeldSlot }
