'use strict'
/** What bots take into their hands. */

const HOTBAR_SIZE = 9

/**
 * Let what is taken into the hand out of a full hotbar's reach change places with what is held.
 * Mineflayer takes the slots in turn, by a count that no snapshot has.
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
