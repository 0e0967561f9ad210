'use strict'
/**
 * Menus: the slots of a window and the moves they allow (see lib/clicks.js). The last 36 slots of every window except
 * the player's own are slots 9..44 of its inventory.
 */

const INVENTORY_START = 9
const INVENTORY_END = 45
const HOTBAR_START = 36
const OFF_HAND = 45
const OFF_HAND_BUTTON = 40

const ARMOUR = [
  { slot: 5, fits: /_helmet$|_head$|_skull$|^carved_pumpkin$/ },
  { slot: 6, fits: /_chestplate$|^elytra$/ },
  { slot: 7, fits: /_leggings$/ },
  { slot: 8, fits: /_boots$/ },
]

const range = (start, end) => Array.from({ length: end - start }, (_, i) => start + i)

/** Return one slot of an array of stacks. */
function cell (slots, index) {
  return { get: () => slots[index] ?? null, set: (item) => { slots[index] = item; } }
}

const anyItem = () => true
const wholeStack = (item) => item.stackSize

/**
 * Return the menu of a window: its own slots (`cells`) followed by the player's 36. `rules` contains
 *
 * - `mayPlace(i, item)`: true if cell `i` accepts the item
 * - `result`: index of the slot with a crafting result, or -1; `takeResult()` takes it
 * - `into(item)`: the cells that a shift-click from the inventory may fill
 *
 * `craftSlots` of the menu is the last slot of the crafting grid, or -1. A client waits for the result of a grid.
 */
function containerMenu (cells, player, rules = {}) {
  const own = range(INVENTORY_START, INVENTORY_END).map((i) => cell(player.inventory.slots, i))
  const all = [...cells, ...own]
  const first = cells.length
  const { mayPlace = anyItem, result = -1, takeResult } = rules
  const into = rules.into ?? (() => range(0, first))
  return {
    size: all.length,
    first,
    craftSlots: result === -1 ? -1 : first - 1,
    get: (i) => all[i].get(),
    set: (i, item) => all[i].set(item),
    mayPlace: (i, item) => i >= first || mayPlace(i, item),
    limit: (_, item) => wholeStack(item),
    isResult: (i) => i === result,
    takeResult,
    targets: (i) => (i < first ? range(first, all.length).reverse() : into(all[i].get())),
    hotbar: (button) => (button >= 0 && button < 9 ? all.length - 9 + button : null),
  }
}

function ownTargets (slot) {
  if (slot === 0) return range(INVENTORY_START, INVENTORY_END).reverse()
  if (slot < INVENTORY_START || slot === OFF_HAND) return range(INVENTORY_START, INVENTORY_END)
  return slot < HOTBAR_START
    ? range(HOTBAR_START, INVENTORY_END) : range(INVENTORY_START, HOTBAR_START)
}

function ownHotbar (button) {
  if (button === OFF_HAND_BUTTON) return OFF_HAND
  return button >= 0 && button < 9 ? HOTBAR_START + button : null
}

/** Return the menu of the player's own window; `grid` is the 2x2 crafting grid's `{takeResult}`. */
function inventoryMenu (player, grid) {
  const { slots } = player.inventory
  const armourOf = (slot) => ARMOUR.find((part) => part.slot === slot)
  return {
    size: OFF_HAND + 1,
    first: 0,
    craftSlots: 4,
    get: (i) => slots[i] ?? null,
    set: (i, item) => { slots[i] = item; },
    mayPlace: (i, item) => i !== 0 && (armourOf(i)?.fits.test(item.name) ?? true),
    limit: (i, item) => (armourOf(i) ? 1 : wholeStack(item)),
    isResult: (i) => i === 0,
    takeResult: () => grid.takeResult(),
    targets: ownTargets,
    hotbar: ownHotbar,
  }
}

module.exports = {
  INVENTORY_START, INVENTORY_END, HOTBAR_START, OFF_HAND, range, cell, containerMenu, inventoryMenu,
}
