'use strict'
const { blockPosition, count: checkCount, item: checkItem, show } = require('./lib/arguments')
const { isUnseen, nameOf } = require('./lib/known')
const { answered } = require('./lib/answers')
const { walkToUse } = require('./lib/walking')
const { countOf } = require('./lib/inventory')

/** Return the ingredients that the inventory lacks for `times` crafts of a recipe, as [name, number]. */
function lacking (bot, recipe, times) {
  return recipe.delta.filter(({ count }) => count < 0)
    .map(({ id, count }) => [bot.registry.items[id].name, -count * times - bot.inventory.count(id, null)])
    .filter(([, missing]) => missing > 0)
}

const total = list => list.reduce((sum, [, missing]) => sum + missing, 0)

/** Return a recipe that can be crafted now, or else the recipe that lacks the fewest items. */
function choose ({ bot, fail }, item, wanted, hasTable) {
  const all = bot.recipesAll(item.id, null, true)
  if (all.length === 0) fail(`there is no recipe for ${item.name}. Get it in another way.`)
  const options = all.map(recipe => {
    const times = Math.ceil(wanted / recipe.result.count)
    return { recipe, times, missing: lacking(bot, recipe, times) }
  })
  const best = options.reduce((a, b) => (total(b.missing) < total(a.missing) ||
    (total(b.missing) === total(a.missing) && a.recipe.requiresTable && !b.recipe.requiresTable)
    ? b
    : a))
  if (best.missing.length) {
    fail(`${wanted} ${item.name} cannot be made, missing: ${best.missing.map(([name, number]) => `${number} ${name}`).join(', ')}. Get them first.`)
  }
  if (best.recipe.requiresTable && !hasTable) {
    fail(`${item.name} needs a crafting table. Give the position of one as craftingTablePos.`)
  }
  return best
}

async function goToTable (context, craftingTablePos) {
  const { bot, fail } = context
  const position = blockPosition(context, 'craftingTablePos', craftingTablePos)
  const table = () => {
    const block = bot.blockAt(position)
    if (block?.name !== 'crafting_table') fail(`there is no crafting table at ${show(position)}, but ${nameOf(bot, block)}.`)
    return block
  }
  if (!isUnseen(bot, position)) table()
  await walkToUse(context, position, 'the crafting table')
  return table()
}

module.exports = {
  name: 'craftItem',
  description: 'Make at least count of an item from what you carry. Recipes that fit into 2 by 2 slots need no table; craftingTablePos may then be null.',
  fails: 'there is no recipe; ingredients are missing (the error lists them); the recipe needs a crafting table, but craftingTablePos is null or no table stands there; there is no path to it; the inventory has no room for the product',
  parameters: [
    { name: 'name', type: 'string', description: 'name of the item to make' },
    { name: 'craftingTablePos', type: 'Vec3 | null', description: 'position of a crafting table', aim: 'uses' },
    { name: 'count', type: 'number', description: 'how many to make; 1 if left out' }
  ],
  example: 'await craftItem(bot, "oak_planks", null, 4)',
  async run (context, name, craftingTablePos, count = 1) {
    const { bot, fail } = context
    const item = checkItem(context, 'name', name)
    const wanted = checkCount(context, 'count', count)
    const hasTable = craftingTablePos !== null && craftingTablePos !== undefined
    const { recipe, times } = choose(context, item, wanted, hasTable)
    const table = recipe.requiresTable ? await goToTable(context, craftingTablePos) : null
    const before = countOf(bot, item)
    try {
      await bot.craft(recipe, times, table)
    } finally {
      await answered(context)
    }
    if (countOf(bot, item) - before < wanted) fail(`only ${countOf(bot, item) - before} of ${wanted} ${item.name} came out. Make room in the inventory and try again.`)
  }
}
