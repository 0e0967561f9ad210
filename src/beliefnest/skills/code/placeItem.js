'use strict'
const { blockPosition, item: checkItem, show } = require('./lib/arguments')
const { nameOf } = require('./lib/known')
const { answered } = require('./lib/answers')
const { canSee, canUse, stepToView, walk, viewpoint } = require('./lib/walking')
const { hold, stackOf } = require('./lib/inventory')

const FACES = [[0, -1, 0], [0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0]]
const FREE = new Set(['air', 'cave_air', 'void_air', 'water', 'lava', 'short_grass', 'tall_grass', 'fern', 'snow', 'dead_bush', 'vine'])
const OPENS = /chest$|barrel|furnace|smoker|crafting_table|_door$|_trapdoor$|_gate$|_bed$|lever|_button$/

/**
 * Return the blocks next to a position against which an item can be placed; blocks that react to a click come last.
 */
function references ({ bot }, place) {
  return FACES.map(([x, y, z]) => bot.blockAt(place.offset(x, y, z)))
    .filter(block => block && block.boundingBox === 'block' && block.name !== 'barrier')
    .sort((a, b) => OPENS.test(a.name) - OPENS.test(b.name))
}

function inTheWay (feet, place) {
  return feet.equals(place) || feet.offset(0, 1, 0).equals(place)
}

async function walkToPlace (context, place, reference) {
  const { bot } = context
  const sees = eye => canUse(bot, eye, place) || (canUse(bot, eye, reference.position) && canSee(bot, eye, place))
  const { goal, arrived } = viewpoint(context, place, (feet, eye) => !inTheWay(feet, place) && sees(eye))
  await walk(context, goal, arrived, place, 'a place to build from, near the position')
  await stepToView(context, place)
}

async function put ({ bot, fail }, reference, place, name) {
  const sneaks = OPENS.test(reference.name)
  if (sneaks) bot.setControlState('sneak', true)
  try {
    await bot.placeBlock(reference, place.minus(reference.position))
  } catch (error) {
    fail(`${name} could not be placed at ${show(place)}: somebody stands there, or it does not hold there.`, error)
  } finally {
    if (sneaks) bot.setControlState('sneak', false)
  }
}

module.exports = {
  name: 'placeItem',
  scripted: true,
  description: 'Go there and place a block from your inventory at the position, which must be free and beside a solid block.',
  fails: 'you do not carry the item; the position is not free, or has no solid block beside it; there is no path on foot; somebody stands there',
  parameters: [
    { name: 'name', type: 'string', description: 'name of the item to place' },
    { name: 'position', type: 'Vec3', description: 'where to place it', aim: 'uses' }
  ],
  example: 'await placeItem(bot, "crafting_table", new Vec3(4, -51, 2))',
  check: (context, name, position) => [checkItem(context, 'name', name), blockPosition(context, 'position', position)],
  async run (context, item, place) {
    const { bot, fail } = context
    const { name } = item
    stackOf(context, item)
    const there = bot.blockAt(place)
    if (!there || !FREE.has(there.name)) {
      fail(`${show(place)} is not free: ${nameOf(bot, there)} is there. Choose a free position.`)
    }
    const [reference] = references(context, place)
    if (!reference) fail(`there is no solid block beside ${show(place)} to put ${name} against. Choose a position on the ground or at a wall.`)
    await walkToPlace(context, place, reference)
    await hold(context, item)
    await put(context, reference, place, name)
    await answered(context)
  }
}
