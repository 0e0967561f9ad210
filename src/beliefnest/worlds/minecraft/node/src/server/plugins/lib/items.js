'use strict'
/** Item stacks (prismarine-item) as immutable values: no function changes a stack in place. */

/** Return true if two stacks can be merged. */
function alike (a, b) {
  return Boolean(a && b) && a.type === b.type &&
    JSON.stringify(a.nbt ?? null) === JSON.stringify(b.nbt ?? null)
}

/** Return true if two slots hold the same (both may be empty). */
function equal (a, b) {
  if (!a || !b) return !a && !b
  return a.count === b.count && alike(a, b)
}

/** Return the same kind of item with another count; null for a count of zero. */
function withCount (item, count) {
  if (count <= 0) return null
  const copy = new item.constructor(item.type, count, item.metadata, item.nbt)
  return copy
}

/** Return counts by name of slots, in order of first appearance. */
function countByName (slots) {
  const counts = {}
  for (const item of slots) {
    if (item) counts[item.name] = (counts[item.name] ?? 0) + item.count
  }
  return counts
}

/** Return after - before, without zeros. */
function difference (before, after) {
  const result = {}
  for (const name of new Set([...Object.keys(before), ...Object.keys(after)])) {
    const change = (after[name] ?? 0) - (before[name] ?? 0)
    if (change !== 0) result[name] = change
  }
  return result
}

/** Return slots as rows `[slot, name, count]`, without empty ones. */
function rowsOf (slots) {
  return [...slots].flatMap((item, slot) => (item ? [[slot, item.name, item.count]] : []))
}

/** Return slots from their rows. */
function slotsOf (Item, registry, rows, size) {
  const slots = new Array(size).fill(null)
  for (const [slot, name, count] of rows) slots[slot] = new Item(registry.itemsByName[name].id, count)
  return slots
}

/** Return stacks for counts by name, sorted by name; a count above the maximum stack size gives several stacks. */
function stacksOf (Item, registry, counts) {
  const stacks = []
  for (const [name, count] of Object.entries(counts).sort(([a], [b]) => (a < b ? -1 : 1))) {
    const data = Object.hasOwn(registry.itemsByName, name) ? registry.itemsByName[name] : null
    if (!data) throw new RangeError(`there is no item called ${name}`)
    if (!Number.isInteger(count) || count < 0) {
      throw new RangeError(`the count of ${name} is ${count}; it must be a whole number, not negative`)
    }
    for (let left = count; left > 0; left -= data.stackSize) {
      stacks.push(new Item(data.id, Math.min(left, data.stackSize)))
    }
  }
  return stacks
}

module.exports = { alike, equal, withCount, countByName, difference, rowsOf, slotsOf, stacksOf }
