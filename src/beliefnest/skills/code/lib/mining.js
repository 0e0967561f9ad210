'use strict'
/** Mining blocks with the best carried tool, and picking up the drops. */
const { show } = require('./arguments')
const { centreOf, walk, walkToUse } = require('./walking')
const { isUnseen, nameOf } = require('./known')
const { answered } = require('./answers')
const { until } = require('./waiting')

const NEAR = 2.5
const PICKUP_TICKS = 100
const MOST_TRIES = 3

function findBlock ({ bot, fail }, position, name) {
  const block = bot.blockAt(position)
  if (block?.name !== name) {
    fail(`there is no ${name} at ${show(position)}, but ${nameOf(bot, block)}. Look where it is, for instance with bot.findBlock.`)
  }
  if (!block.diggable) fail(`${name} cannot be mined.`)
  return block
}

const timeWith = (block, item) => block.digTime(item?.type ?? null, false, false, false, item?.enchants ?? [], {})

/** Hold the tool that mines a block fastest; fail if no carried tool yields any drops. */
async function takeTool ({ bot, fail }, block) {
  const { harvestTools, name } = block
  const able = item => !harvestTools || Boolean(item && harvestTools[item.type])
  const tools = bot.inventory.items().filter(able)
  if (!able(null) && tools.length === 0) {
    const names = Object.keys(harvestTools).map(id => bot.registry.items[id].name)
    fail(`${name} needs one of these tools: ${names.join(', ')}; the inventory holds none of them. Make or get one first.`)
  }
  const best = [bot.heldItem, ...tools].filter(item => item && able(item))
    .reduce((a, b) => (a && timeWith(block, a) <= timeWith(block, b) ? a : b), null)
  const bare = able(null) ? timeWith(block, null) : Infinity
  if (best && timeWith(block, best) < bare && bot.heldItem !== best) await bot.equip(best, 'hand')
}

const itemsNear = (bot, place) => Object.values(bot.entities)
  .filter(entity => entity.name === 'item' && entity.position.distanceTo(place) <= NEAR)

async function pickUp (context, entity) {
  const { bot, goals, fail } = context
  const gone = () => !bot.entities[entity.id]
  const at = entity.position.floored()
  const near = () => gone() || bot.entity.position.distanceTo(entity.position) < 1
  await walk(context, new goals.GoalNear(at.x, at.y, at.z, 0.5), near, entity.position, 'what was dropped')
  if (await until(context, gone, PICKUP_TICKS)) return answered(context)
  fail(`${entity.getDroppedItem()?.name ?? 'an item'} was left lying at ${show(at)}: the inventory has no room for it. Put something away first.`)
}

/** Dig until the server confirms it. A server that lags may find that the block was not dug for long enough. */
async function digOut (context, { name, position }) {
  const { bot } = context
  for (let tries = 0; tries < MOST_TRIES && bot.blockAt(position).name === name; tries++) {
    await bot.dig(bot.blockAt(position), true)
    await answered(context)
  }
}

/** Go to a block, mine it and pick up its drops. */
async function mine (context, position, name) {
  const { bot } = context
  if (!isUnseen(bot, position)) findBlock(context, position, name)
  await walkToUse(context, position, `the ${name}`)
  const block = findBlock(context, position, name)
  await takeTool(context, block)
  const before = new Set(itemsNear(bot, centreOf(position)).map(({ id }) => id))
  await digOut(context, block)
  if (bot.blockAt(position).name === name) context.fail(`${name} at ${show(position)} is still there: it was not mined long enough. Try again.`)
  for (const entity of itemsNear(bot, centreOf(position)).filter(({ id }) => !before.has(id))) {
    await pickUp(context, entity)
  }
}

module.exports = { mine }
