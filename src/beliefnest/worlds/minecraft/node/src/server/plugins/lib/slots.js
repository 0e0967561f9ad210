'use strict'
/** Possessions of a player as the slots of an inventory. */

const { INVENTORY_START, HOTBAR_START, OFF_HAND } = require('./menus')
const { countByName, stacksOf } = require('./items')
const { store } = require('./clicks')

const WORN = { head: 5, chest: 6, legs: 7, feet: 8, off_hand: OFF_HAND }
/** Order in which new items fill slots: hotbar first, as in the game. */
const STORE_ORDER = [
  ...Array.from({ length: 9 }, (_, i) => HOTBAR_START + i),
  ...Array.from({ length: HOTBAR_START - INVENTORY_START }, (_, i) => INVENTORY_START + i),
]

function storage (slots) {
  return {
    get: (i) => slots[i] ?? null,
    set: (i, item) => { slots[i] = item; },
    mayPlace: () => true,
    limit: (_, item) => item.stackSize,
  }
}

/** Return the slots of a player with given possessions who holds the first slot of the hotbar. */
function layOut ({ Item, registry }, size, { inventory, equipment }, who) {
  const slots = new Array(size).fill(null)
  const rest = { ...inventory }
  const take = (name) => {
    if (!(rest[name] > 0)) throw new RangeError(`${who} cannot wear or hold ${name}: the inventory has none`)
    rest[name] -= 1
    return new Item(registry.itemsByName[name].id, 1)
  }
  for (const [part, slot] of Object.entries(WORN)) {
    if (equipment[part]) slots[slot] = take(equipment[part])
  }
  const [firstSlot, ...others] = STORE_ORDER
  if (equipment.main_hand) slots[firstSlot] = take(equipment.main_hand)
  const free = equipment.main_hand ? STORE_ORDER : [...others, firstSlot]
  for (const stack of stacksOf(Item, registry, rest)) {
    const inOffHand = slots[OFF_HAND]?.name === stack.name ? [OFF_HAND] : []
    if (store(storage(slots), stack, [...free, ...inOffHand])) {
      throw new RangeError(`the inventory given to ${who} does not fit in 36 slots: ${stack.name} is left over`)
    }
  }
  return slots
}

/** Return the possessions in stacks; the stack of slot 0 is that on the cursor. */
function possessionsOf (stacks, heldStack) {
  const equipment = {}
  for (const [part, slot] of Object.entries(WORN)) {
    if (stacks[slot]) equipment[part] = stacks[slot].name
  }
  if (heldStack) equipment.main_hand = heldStack.name
  return { inventory: countByName([...stacks.slice(1), stacks[0]]), equipment }
}

module.exports = { layOut, possessionsOf, storage, STORE_ORDER }
