'use strict'
/** Opening a chest as a player does, and moving counted items between it and the inventory. */
const { show } = require('./arguments')
const { walkToUse } = require('./walking')

const CONTAINERS = ['chest', 'trapped_chest', 'barrel']

function findContainer ({ bot, fail }, position) {
  const block = bot.blockAt(position)
  if (!CONTAINERS.includes(block?.name)) {
    fail(`there is no chest at ${show(position)}, but ${block ? block.name : 'nothing that is loaded'}. Give the position of a chest or barrel.`)
  }
  return block
}

function checkLid ({ bot, fail }, block) {
  const above = bot.blockAt(block.position.offset(0, 1, 0))
  if (block.name === 'barrel' || !above || above.boundingBox !== 'block' || above.transparent) return
  fail(`the chest at ${show(block.position)} cannot be opened: ${above.name} lies on its lid. Remove it first.`)
}

/** Goes to the container, opens it, hands its window to `action`, and closes it whatever happens. */
async function withContainer (context, position, action) {
  const { bot } = context
  findContainer(context, position)
  await walkToUse(context, position, 'the chest')
  const block = findContainer(context, position)
  checkLid(context, block)
  const window = await bot.openContainer(block)
  try {
    return await action(window)
  } finally {
    await bot.closeWindow(window)
  }
}

/** How many of an item can still be put into slots start..end of a window. */
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

/**
 * Moves up to `wanted` of an item from one part of a window ("chest", "inventory") to the other.
 * @returns {Promise<{there: number, room: number, moved: number}>}
 */
async function move ({ bot }, window, from, to, item, wanted) {
  const parts = partsOf(window)
  const there = window.countRange(...parts[from], item.id, null)
  const room = roomFor(window, ...parts[to], item)
  const moved = Math.min(wanted, there, room)
  if (moved > 0) {
    await bot.transfer({
      window,
      itemType: item.id,
      metadata: null,
      count: moved,
      sourceStart: parts[from][0],
      sourceEnd: parts[from][1],
      destStart: parts[to][0],
      destEnd: parts[to][1]
    })
  }
  return { there, room, moved }
}

module.exports = { withContainer, move }
