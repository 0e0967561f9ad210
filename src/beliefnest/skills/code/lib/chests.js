'use strict'
/** Opening a chest as a player does, and moving counted items between it and the inventory. */
const { show } = require('./arguments')
const { isUnseen, nameOf } = require('./known')
const { answered } = require('./answers')
const { walkToUse } = require('./walking')

const CONTAINERS = ['chest', 'trapped_chest', 'barrel']

function findContainer ({ bot, fail }, position) {
  const block = bot.blockAt(position)
  if (!CONTAINERS.includes(block?.name)) {
    fail(`there is no chest at ${show(position)}, but ${nameOf(bot, block)}. Give the position of a chest or barrel.`)
  }
  return block
}

/** Go to the container, open it, call `action` with its window, and close it in any case. */
async function withContainer (context, position, action) {
  const { bot } = context
  if (!isUnseen(bot, position)) findContainer(context, position)
  await walkToUse(context, position, 'the chest')
  const block = findContainer(context, position)
  const window = await bot.openContainer(block)
  try {
    return await action(window)
  } finally {
    if (bot.currentWindow === window) await bot.closeWindow(window)
    await answered(context)
  }
}

/** Return how many more of an item fit into slots start..end of a window. */
function roomFor (window, start, end, item) {
  return window.slots.slice(start, end).reduce((room, slot) => {
    if (!slot) return room + item.stackSize
    return slot.type === item.id ? room + item.stackSize - slot.count : room
  }, 0)
}

const partsOf = window => ({
  chest: [0, window.inventoryStart],
  inventory: [window.inventoryStart, window.inventoryEnd]
})

function transfer (bot, window, [sourceStart, sourceEnd], [destStart, destEnd], item, count) {
  return bot.transfer({ window, itemType: item.id, metadata: null, count, sourceStart, sourceEnd, destStart, destEnd })
}

/** Return how many of an item the bot has, those on the cursor included. */
function owned (window, item) {
  const { selectedItem } = window
  return window.countRange(...partsOf(window).inventory, item.id, null) + (selectedItem?.type === item.id ? selectedItem.count : 0)
}

/**
 * Move items from one part of a window ("chest", "inventory") to the other.
 * @param {[object, number][]} wanted items and the most to move of each
 * @returns {Promise<{item: object, count: number, there: number, room: number, moved: number}[]>} `moved` is the
 *   number that the server accepted: another player may use the same chest
 */
async function move (context, window, from, to, wanted) {
  const { bot, fail } = context
  const parts = partsOf(window)
  const outcomes = []
  for (const [item, count] of wanted) {
    const there = window.countRange(...parts[from], item.id, null)
    const room = roomFor(window, ...parts[to], item)
    outcomes.push({ item, count, there, room, before: owned(window, item) })
    const possible = Math.min(count, there, room)
    if (possible > 0) await transfer(bot, window, parts[from], parts[to], item, possible)
  }
  await answered(context)
  if (bot.currentWindow !== window) fail('the chest was closed while items were moved. Open it again.')
  return outcomes.map(({ before, ...outcome }) => ({ ...outcome, moved: Math.abs(owned(window, outcome.item) - before) }))
}

module.exports = { withContainer, move }
