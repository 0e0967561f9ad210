'use strict'
const { blockPosition, count: checkCount, item: checkItem, show } = require('./lib/arguments')
const { nameOf } = require('./lib/known')
const { answered } = require('./lib/answers')
const { walkToUse } = require('./lib/walking')
const { countOf, contents } = require('./lib/inventory')
const { ticks, until } = require('./lib/waiting')

const FURNACES = ['furnace', 'blast_furnace', 'smoker']
const LIGHTING_TICKS = 2
const ITEM_TICKS = 600

function checkAmount ({ bot, fail }, item, wanted) {
  if (countOf(bot, item) < wanted) {
    fail(`${wanted} ${item.name} asked for, the inventory holds ${countOf(bot, item)}. Get more first; there is: ${contents(bot)}.`)
  }
}

function findFurnace ({ bot, fail }, position) {
  const block = bot.blockAt(position)
  if (!FURNACES.includes(block?.name)) {
    fail(`there is no furnace at ${show(position)}, but ${nameOf(bot, block)}.`)
  }
  return block
}

function checkEmpty ({ fail }, furnace, item, fuel) {
  const [input, burning, output] = [furnace.inputItem(), furnace.fuelItem(), furnace.outputItem()]
  if (input && input.type !== item.id) fail(`the furnace is busy with ${input.name}. Take it out first.`)
  if (burning && burning.type !== fuel.id) fail(`the furnace has ${burning.name} as fuel. Use that, or take it out first.`)
  if (output) fail(`${output.count} ${output.name} lie in the furnace. Take them out first.`)
}

/** Wait until the furnace has had time to light or go out, and the bot has received its state. */
async function nextTicks (context) {
  await answered(context)
  await ticks(context, LIGHTING_TICKS)
  await answered(context)
}

/** Put one piece of fuel in; fail if the furnace does not accept it. */
async function feed (context, furnace, fuel) {
  const { bot, fail } = context
  await furnace.putFuel(fuel.id, null, 1)
  await nextTicks(context)
  if (!furnace.selectedItem) return
  await bot.putSelectedItemRange(furnace.inventoryStart, furnace.inventoryEnd, furnace, null)
  fail(`${fuel.name} does not burn. Use a fuel such as coal or planks.`)
}

/** Smelt the items in the furnace, and keep one piece of fuel ready, until the fuel runs out. */
async function smelt (context, furnace, position, item, fuel, wanted) {
  const { bot, fail } = context
  const done = () => furnace.outputItem()?.count ?? 0
  const lit = () => bot.blockAt(position).getProperties().lit
  const needsFuel = () => !furnace.fuelItem() && countOfWindow(furnace, fuel.id) > 0
  while (done() < wanted) {
    checkOpen(context, furnace)
    if (needsFuel()) await feed(context, furnace, fuel)
    if (!lit() && furnace.fuelItem()) fail(`${item.name} cannot be smelted in a ${bot.blockAt(position).name}. Try another kind of furnace.`)
    if (!lit()) return
    const before = done()
    const went = await until(context, () => done() > before || needsFuel() || !lit(), ITEM_TICKS)
    if (!went) fail(`nothing came out of the furnace for ${ITEM_TICKS} ticks.`)
    if (!lit()) await nextTicks(context)
  }
}

const countOfWindow = (window, type) => window.countRange(window.inventoryStart, window.inventoryEnd, type, null)

// Fail if the furnace was closed: clicks meant for it would go to the inventory.
function checkOpen ({ bot, fail }, furnace) {
  if (bot.currentWindow !== furnace) fail('the furnace was closed before everything was taken out.')
}

/**
 * Take everything out of the furnace. Return the product and the number of pieces that came out, or null if there is
 * no product.
 */
async function emptyFurnace (context, furnace) {
  checkOpen(context, furnace)
  if (furnace.inputItem()) await furnace.takeInput()
  if (furnace.fuelItem()) await furnace.takeFuel()
  const output = furnace.outputItem()
  if (!output) return null
  const before = countOfWindow(furnace, output.type)
  await furnace.takeOutput()
  await answered(context)
  return { name: output.name, count: countOfWindow(furnace, output.type) - before }
}

module.exports = {
  name: 'smeltItem',
  description: 'Go to the furnace, smelt count of an item with the fuel, wait for it, and take out what was made and what is left.',
  fails: 'there is no path on foot; there is no furnace, or it is in use; you carry fewer items; the fuel does not burn, or it runs out (finished items are taken); the item cannot be smelted',
  parameters: [
    { name: 'itemName', type: 'string', description: 'what to smelt' },
    { name: 'fuelName', type: 'string', description: 'what to burn' },
    { name: 'furnacePos', type: 'Vec3', description: 'position of a furnace, blast furnace or smoker', aim: 'uses' },
    { name: 'count', type: 'number', description: 'how many; 1 if left out' }
  ],
  example: 'await smeltItem(bot, "raw_iron", "coal", new Vec3(4, -51, 2), 3)',
  async run (context, itemName, fuelName, furnacePos, count = 1) {
    const { bot, fail } = context
    const item = checkItem(context, 'itemName', itemName)
    const fuel = checkItem(context, 'fuelName', fuelName)
    const position = blockPosition(context, 'furnacePos', furnacePos)
    const wanted = checkCount(context, 'count', count)
    checkAmount(context, item, wanted)
    checkAmount(context, fuel, 1)
    findFurnace(context, position)
    await walkToUse(context, position, 'the furnace')
    const furnace = await bot.openFurnace(findFurnace(context, position))
    let made = 0
    try {
      checkEmpty(context, furnace, item, fuel)
      await furnace.putInput(item.id, null, wanted)
      try {
        await smelt(context, furnace, position, item, fuel, wanted)
      } finally {
        const output = await emptyFurnace(context, furnace)
        made = output?.count ?? 0
      }
    } finally {
      if (bot.currentWindow === furnace) await furnace.close()
      await answered(context)
    }
    if (made < wanted) fail(`${made} of ${wanted} ${item.name} were smelted, then the ${fuel.name} ran out. Get more fuel.`)
  }
}
