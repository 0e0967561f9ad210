'use strict'
/**
 * Balance of a region in materials: crafting, smelting, placing and mining change the kinds of things but not their
 * worth. Only items that were eaten, burnt or mined without a drop may be missing.
 */

const WORTH = {
  oak_log: { wood: 4 }, stripped_oak_log: { wood: 4 }, oak_planks: { wood: 1 }, stick: { wood: 0.5 },
  stone: { rock: 1 }, cobblestone: { rock: 1 }, raw_iron: { iron: 1 }, iron_ingot: { iron: 1 }, sand: { sand: 1 }, glass: { sand: 1 },
  torch: { coal: 0.25, wood: 0.125 }, wall_torch: { coal: 0.25, wood: 0.125 }
}
/** Blocks of two parts that are one item. */
const HALVES = /_door$|_bed$/
const LEAST_BURNING = { wood: 100, coal: 1600 }
const MOST_OF_A_FUEL = { wood: 8, coal: 1 }
const FOOD = ['apple', 'bread']
/** Blocks that drop nothing; skills mine all others with a suitable tool. */
const BREAKS = /glass/

/**
 * Return a function from items to materials: those of the table, or those of the item's ingredients, or the item
 * itself.
 */
function worthTable (registry) {
  const worths = new Map()
  const crafted = new Set(['chest', 'crafting_table', 'furnace', 'barrel', 'lever', 'ladder', 'bowl', 'wooden_pickaxe', 'stone_pickaxe', 'wooden_axe',
    'wooden_shovel', 'wooden_hoe', 'wooden_sword', 'stone_axe', 'stone_shovel', 'stone_hoe', 'stone_sword', 'oak_door', 'oak_slab', 'oak_stairs', 'oak_fence',
    'oak_button', 'oak_pressure_plate', 'oak_trapdoor', 'oak_sign', 'oak_boat', 'oak_fence_gate', 'iron_helmet', 'shears', 'bucket'])
  function worth (name) {
    if (!worths.has(name)) worths.set(name, WORTH[name] ?? (crafted.has(name) ? fromRecipe(name) : { [name]: 1 }))
    return worths.get(name)
  }
  function fromRecipe (name) {
    const options = registry.recipes[registry.itemsByName[name].id].map(recipe => materialsOf(recipe))
    return options.find(materials => Object.keys(materials).every(key => ['wood', 'rock', 'iron'].includes(key))) ?? { [name]: 1 }
  }
  function materialsOf ({ inShape, ingredients, result }) {
    const total = {}
    for (const id of (inShape?.flat() ?? ingredients).map(entry => entry?.id ?? entry).filter(id => id !== null && id !== -1)) {
      // Only these items are taken apart; the recipes of all others form cycles.
      const { name } = registry.items[id]
      for (const [key, value] of Object.entries(WORTH[name] ?? { [name]: 1 })) total[key] = (total[key] ?? 0) + value / result.count
    }
    return total
  }
  return worth
}

/**
 * Return the amount of each material, placed blocks included.
 * @param {(name: string) => object} worth
 * @param {object} snapshot SNAPSHOT of the region
 * @param {(state: number) => {name: string}} describe describes a block state
 * @returns {Object<string, number>}
 */
function materials (worth, snapshot, describe) {
  const total = {}
  const add = (name, count) => Object.entries(worth(name)).forEach(([key, value]) => { total[key] = (total[key] ?? 0) + value * count })
  const addAll = counts => Object.entries(counts).forEach(([name, count]) => add(name, count))
  snapshot.containers.forEach(([,,, items]) => addAll(items))
  Object.values(snapshot.agents).forEach(({ inventory }) => addAll(inventory))
  Object.values(snapshot.items).forEach(({ name, count }) => add(name, count))
  const counts = new Map()
  const runs = new Int32Array(snapshot.blocks.slice().buffer)
  for (let row = 0; row < runs.length; row += 2) counts.set(runs[row], (counts.get(runs[row]) ?? 0) + runs[row + 1])
  for (const [state, count] of counts) {
    const { name } = describe(state)
    if (name !== 'air') add(name, HALVES.test(name) ? count / 2 : count)
  }
  return total
}

/**
 * Return how much of each material may be missing after the events of some frames.
 * @param {object[]} frames
 * @param {Object<string, number>} food food level of each agent before
 * @param {number} ticks number of ticks that passed
 * @param {number} furnaces largest number of furnaces
 */
function mayBeMissing (worth, frames, food, ticks, furnaces) {
  const missing = {}
  const add = (materialCounts, times) => Object.entries(materialCounts).forEach(([key, value]) => { missing[key] = (missing[key] ?? 0) + value * times })
  const level = { ...food }
  for (const { agents, events } of frames) {
    for (const [name, agent] of Object.entries(agents)) {
      if (agent.food > level[name]) FOOD.forEach(item => add({ [item]: 1 }, 1))
      level[name] = agent.food
    }
    for (const { kind, detail } of events) {
      if (kind === 'mine_block' && BREAKS.test(detail.block)) add(worth(detail.block.split('[')[0]), 1)
    }
  }
  for (const [key, least] of Object.entries(LEAST_BURNING)) add({ [key]: MOST_OF_A_FUEL[key] }, furnaces * (1 + Math.ceil(ticks / least)))
  return missing
}

/** Return the differences that are not explained, by material; empty if there are none. @returns {string[]} */
function unexplained (before, after, missing) {
  return [...new Set([...Object.keys(before), ...Object.keys(after)])].flatMap(key => {
    const change = (after[key] ?? 0) - (before[key] ?? 0)
    if (change > 1e-6) return [`${change} ${key} came out of nothing`]
    return -change > (missing[key] ?? 0) + 1e-6 ? [`${-change} ${key} are missing, ${missing[key] ?? 0} may be`] : []
  })
}

module.exports = { materials, mayBeMissing, unexplained, worthTable }
