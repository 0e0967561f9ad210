'use strict'
/** Blocks that hold items on a server: how many slots each has, and where what is put in by hand goes. */
const { arrange, SIZE } = require('../server/plugins/lib/fire')
const { stacksOf } = require('../server/plugins/lib/items')
const { KINDS } = require('../server/plugins/lib/smelting')

const CHEST_SIZE = 27
const CHESTS = ['chest', 'trapped_chest', 'barrel']

/** @returns {number} 0 for a block that holds nothing */
function slotsIn (name) {
  if (CHESTS.includes(name)) return CHEST_SIZE
  return KINDS.includes(name) ? SIZE : 0
}

/** @returns {Array} stacks by slot. @throws {RangeError} where the items do not fit */
function slotted (Item, registry, name, items) {
  const stacks = stacksOf(Item, registry, items)
  const size = slotsIn(name)
  if (size === 0) throw new RangeError(`there is no container, but ${name}`)
  const slots = size === SIZE ? arrange(name, stacks) : stacks
  if (slots === null || slots.length > size) throw new RangeError(`the items given do not fit into the ${size} slots of the ${name}`)
  return Array.from({ length: size }, (_, slot) => slots[slot] ?? null)
}

module.exports = { isFurnace: name => KINDS.includes(name), slotsIn, slotted }
