'use strict'
/**
 * Tables of drops, smelting and fuel, compared with other sources than those they were made from: the loot tables and
 * recipes of the game's own data pack, and the wiki's table of fuels. The values here were copied from those sources;
 * design/decisions.md says what was compared as a whole.
 */
const test = require('node:test')
const assert = require('node:assert/strict')
const registry = require('prismarine-registry')('1.20.4')
const { dropsOf } = require('../../src/server/plugins/lib/drops')
const { burnTicks, resultOf, ticksOf } = require('../../src/server/plugins/lib/smelting')
const { decode } = require('../../src/server/plugins/lib/states')

const PICKAXE = { type: registry.itemsByName.netherite_pickaxe.id, enchants: [] }

/** Return the least and the most that a block drops, as "name low-high". */
function drops (name, properties = {}) {
  const block = { name, properties: { ...decode(registry, registry.blocksByName[name].defaultState), ...properties } }
  const [least, most] = [0, 0.999999].map(chance => dropsOf(registry, block, PICKAXE, () => chance))
  const countIn = (list, item) => list.find(({ name: other }) => other === item)?.count ?? 0
  return most.map(({ name: item, count }) => `${item} ${countIn(least, item)}-${count}`).join(', ')
}

test('blocks drop what the game has them drop', () => {
  const expected = {
    stone: 'cobblestone 1-1', coal_ore: 'coal 1-1', deepslate_diamond_ore: 'diamond 1-1', iron_ore: 'raw_iron 1-1', copper_ore: 'raw_copper 2-5',
    lapis_ore: 'lapis_lazuli 4-9', redstone_ore: 'redstone 4-5', nether_gold_ore: 'gold_nugget 2-6', nether_quartz_ore: 'quartz 1-1',
    ancient_debris: 'ancient_debris 1-1', glowstone: 'glowstone_dust 2-4', melon: 'melon_slice 3-7', sea_lantern: 'prismarine_crystals 2-3', clay: 'clay_ball 4-4',
    bookshelf: 'book 3-3', ender_chest: 'obsidian 8-8', glass: '', ice: '', spawner: '', chest: 'chest 1-1', oak_log: 'oak_log 1-1',
    grass_block: 'dirt 1-1', red_bed: 'red_bed 1-1'
  }
  assert.deepEqual(Object.fromEntries(Object.keys(expected).map(name => [name, drops(name)])), expected)
  assert.equal(drops('oak_slab', { type: 'double' }), 'oak_slab 2-2')
})

test('nothing drops air, or none of something', () => {
  for (const { name, defaultState } of registry.blocksArray) {
    for (const chance of [0, 0.999999]) {
      const dropped = dropsOf(registry, { name, properties: decode(registry, defaultState) }, PICKAXE, () => chance)
      assert.ok(dropped.every(drop => drop.name !== 'air' && drop.count >= 1), `${name}: ${JSON.stringify(dropped)}`)
    }
  }
})

const NAMES = registry.itemsArray.map(({ name }) => name)
const WOODS = ['oak', 'spruce', 'birch', 'jungle', 'acacia', 'dark_oak', 'mangrove', 'cherry', 'bamboo']
const GROWN = WOODS.filter(wood => wood !== 'bamboo')
const of = (woods, ...kinds) => woods.flatMap(wood => kinds.map(kind => `${wood}_${kind}`))
const ending = (end, except = /^$/) => NAMES.filter(name => name.endsWith(end) && !except.test(name))

const BURNING = [
  [20000, ['lava_bucket']], [16000, ['coal_block']], [4001, ['dried_kelp_block']], [2400, ['blaze_rod']], [1600, ['coal', 'charcoal']],
  [1200, [...of(GROWN, 'boat', 'chest_boat'), 'bamboo_raft', 'bamboo_chest_raft']], [800, of(WOODS, 'hanging_sign')],
  [300, [
    ...of(GROWN, 'log', 'wood').flatMap(name => [name, `stripped_${name}`]), 'bamboo_block', 'stripped_bamboo_block', 'bamboo_mosaic',
    'bamboo_mosaic_stairs', 'mangrove_roots', ...of(WOODS, 'planks', 'stairs', 'trapdoor', 'pressure_plate', 'fence', 'fence_gate'), 'note_block',
    'bookshelf', 'chiseled_bookshelf', 'lectern', 'jukebox', 'chest', 'trapped_chest', 'crafting_table', 'daylight_detector', 'bow', 'crossbow',
    'fishing_rod', 'ladder', 'loom', 'barrel', 'cartography_table', 'fletching_table', 'smithing_table', 'composter', ...ending('_banner')
  ]],
  [200, ['wooden_pickaxe', 'wooden_shovel', 'wooden_axe', 'wooden_hoe', 'wooden_sword', ...of(WOODS, 'sign', 'door')]],
  [150, [...of(WOODS, 'slab'), 'bamboo_mosaic_slab']],
  [100, [
    'stick', 'bowl', 'dead_bush', 'azalea', 'flowering_azalea', 'mangrove_propagule', ...ending('_sapling'), ...ending('_wool'), ...of(WOODS, 'button')
  ]],
  [67, ending('_carpet', /^moss/)], [50, ['bamboo', 'scaffolding']]
]

test('these burn, for so long, and nothing else does', () => {
  const expected = BURNING.flatMap(([ticks, names]) => names.map(name => [name, ticks])).sort()
  assert.deepEqual(expected.filter(([name]) => !NAMES.includes(name)), [])
  const ticks = NAMES.filter(name => burnTicks(name) > 0).map(name => [name, burnTicks(name)]).sort()
  assert.deepEqual(ticks, expected)
})

test('furnaces make of everything what the game makes of it', () => {
  const count = kind => NAMES.filter(name => resultOf(kind, name) !== undefined).length
  assert.deepEqual(['furnace', 'blast_furnace', 'smoker'].map(ticksOf), [200, 100, 100])
  assert.equal(count('smoker'), 9)
  const examples = {
    raw_iron: 'iron_ingot', deepslate_redstone_ore: 'redstone', nether_gold_ore: 'gold_ingot', ancient_debris: 'netherite_scrap', stripped_cherry_wood: 'charcoal',
    golden_horse_armor: 'gold_nugget', chainmail_boots: 'iron_nugget', wet_sponge: 'sponge', quartz_block: 'smooth_quartz', basalt: 'smooth_basalt',
    cyan_terracotta: 'cyan_glazed_terracotta', sea_pickle: 'lime_dye', chorus_fruit: 'popped_chorus_fruit', bamboo_block: undefined, diamond: undefined
  }
  assert.deepEqual(Object.fromEntries(Object.keys(examples).map(name => [name, resultOf('furnace', name)])), examples)
})
