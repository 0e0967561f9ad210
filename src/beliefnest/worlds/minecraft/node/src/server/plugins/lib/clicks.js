'use strict'

const { alike, withCount } = require('./items')

/**
 * Effects of clicks in a window, by the rules of the game.
 *
 * A menu is `{get(i), set(i, item), mayPlace(i, item), limit(i, item), targets(i), hotbar(button), isResult(i),
 * takeResult()}`: `targets(i)` are the slots that a shift-click from `i` fills, in order; `takeResult()` returns a
 * crafted result once and consumes its ingredients. No click creates or destroys items: they move between slots,
 * cursor and `dropped`.
 */

const OUTSIDE = -999

function capacity (menu, slot, item) {
  return menu.mayPlace(slot, item) ? Math.min(item.stackSize, menu.limit(slot, item)) : 0
}

/** Put up to `count` of `item` into a slot that is empty or holds equal items. Return the rest. */
function put (menu, slot, item, count) {
  const there = menu.get(slot)
  if (there && !alike(there, item)) return item
  const room = capacity(menu, slot, item) - (there?.count ?? 0)
  const moved = Math.min(room, count, item.count)
  if (moved <= 0) return item
  menu.set(slot, withCount(item, (there?.count ?? 0) + moved))
  return withCount(item, item.count - moved)
}

/** Take a whole stack (left) or half of it onto an empty cursor; put a whole stack or one item down. */
function clickOn (menu, cursor, slot, isLeft) {
  const there = menu.get(slot)
  if (menu.isResult(slot)) return takeResultToCursor(menu, cursor, there)
  if (!cursor) {
    if (!there) return null
    const taken = isLeft ? there.count : Math.ceil(there.count / 2)
    menu.set(slot, withCount(there, there.count - taken))
    return withCount(there, taken)
  }
  if (there && !alike(there, cursor)) return swap(menu, cursor, slot, there)
  if (there && !menu.mayPlace(slot, cursor)) return takeOnto(menu, cursor, slot, there)
  return put(menu, slot, cursor, isLeft ? cursor.count : 1)
}

function swap (menu, cursor, slot, there) {
  if (cursor.count > capacity(menu, slot, cursor)) return cursor
  menu.set(slot, cursor)
  return there
}

/** Take items out of a slot into which nothing can be put, onto the cursor's stack. */
function takeOnto (menu, cursor, slot, there) {
  if (cursor.count + there.count > cursor.stackSize) return cursor
  menu.set(slot, null)
  return withCount(cursor, cursor.count + there.count)
}

function takeResultToCursor (menu, cursor, result) {
  if (!result) return cursor
  if (!cursor) return menu.takeResult()
  if (!alike(cursor, result) || cursor.count + result.count > cursor.stackSize) return cursor
  return withCount(cursor, cursor.count + menu.takeResult().count)
}

/** Store an item in the first suitable slots of `slots`, on equal stacks first. Return the rest. */
function store (menu, item, slots) {
  let left = item
  for (const slot of slots) {
    if (left && menu.get(slot)) left = put(menu, slot, left, left.count)
  }
  for (const slot of slots) {
    if (left && !menu.get(slot)) left = put(menu, slot, left, left.count)
  }
  return left
}

function room (menu, item, slots) {
  return slots.reduce((sum, slot) => {
    const there = menu.get(slot)
    if (there && !alike(there, item)) return sum
    return sum + Math.max(0, capacity(menu, slot, item) - (there?.count ?? 0))
  }, 0)
}

function shiftClick (menu, slot) {
  const slots = menu.targets(slot)
  if (!menu.isResult(slot)) {
    const item = menu.get(slot)
    if (item) menu.set(slot, store(menu, item, slots))
    return
  }
  const first = menu.get(slot)
  for (let next = first; alike(next, first); next = menu.get(slot)) {
    if (room(menu, next, slots) < next.count) return
    store(menu, menu.takeResult(), slots)
  }
}

function numberKey (menu, slot, button) {
  const hotbar = menu.hotbar(button)
  if (hotbar === null || hotbar === slot) return
  const there = menu.get(slot)
  const hotbarStack = menu.get(hotbar)
  if (menu.isResult(slot)) {
    if (there && !hotbarStack) menu.set(hotbar, menu.takeResult())
    return
  }
  if (hotbarStack && hotbarStack.count > capacity(menu, slot, hotbarStack)) return
  if (there && there.count > capacity(menu, hotbar, there)) return
  menu.set(slot, hotbarStack)
  menu.set(hotbar, there)
}

function dropKey (menu, slot, whole) {
  const there = menu.get(slot)
  if (!there) return []
  if (menu.isResult(slot)) return [menu.takeResult()]
  const count = whole ? there.count : 1
  menu.set(slot, withCount(there, there.count - count))
  return [withCount(there, count)]
}

function clickOutside (cursor, mouseButton) {
  if (!cursor) return { cursor, dropped: [] }
  const count = mouseButton === 0 ? cursor.count : 1
  return { cursor: withCount(cursor, cursor.count - count), dropped: [withCount(cursor, count)] }
}

/**
 * Apply a click. Return `{cursor, dropped}`, or null for an unknown click (dragging, double clicks, a slot that does
 * not exist), which changes nothing.
 */
function click (menu, cursor, { slot, mouseButton, mode }) {
  if (slot === OUTSIDE) return mode === 0 || mode === 4 ? clickOutside(cursor, mouseButton) : null
  if (!(slot >= 0 && slot < menu.size)) return null
  if (mode === 0) return { cursor: clickOn(menu, cursor, slot, mouseButton === 0), dropped: [] }
  if (mode === 1) shiftClick(menu, slot)
  else if (mode === 2) numberKey(menu, slot, mouseButton)
  else if (mode === 4) return { cursor, dropped: cursor ? [] : dropKey(menu, slot, mouseButton === 1) }
  else return null
  return { cursor, dropped: [] }
}

module.exports = { click, store }
