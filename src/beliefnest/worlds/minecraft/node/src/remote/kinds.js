'use strict'
/** Containers of a server: number of slots, and the slots for items that are put in by hand. */
const { arrange, SIZE } = require('../server/plugins/lib/fire')
const { stacksOf } = require('../server/plugins/lib/items')
const { KINDS } = require('../server/plugins/lib/smelting')

const CHEST_SIZE = 27
const CHESTS = ['chest', 'trapped_chest', 'barrel']

/** Return the number of slots of a block; 0 for a block that holds nothing. @returns {number} */
function slotsIn (name) {
  if (CHESTS.includes(name)) return CHEST_SIZE
  return KINDS.includes(name) ? SIZE : 0
}

/**
 * Return the stacks by slot.
 * @param {number} count number of such blocks that are one container
 * @returns {Array}
 * @throws {RangeError} if the items do not fit
 */
function slotted (Item, registry, name, items, count = 1) {
  const stacks = stacksOf(Item, registry, items)
  const size = slotsIn(name) * count
  if (size === 0) throw new RangeError(`the block is ${name}, which is no container`)
  const slots = size === SIZE ? arrange(name, stacks) : stacks
  if (slots === null || slots.length > size) throw new RangeError(`the items given do not fit into the ${size} slots of the ${name}`)
  return Array.from({ length: size }, (_, slot) => slots[slot] ?? null)
}

module.exports = { isFurnace: name => KINDS.includes(name), slotsIn, slotted }
