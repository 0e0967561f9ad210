'use strict'
/**
 * Products of furnaces and burning times of fuels, in ticks.
 *
 * Source: Minecraft: Java Edition 1.20.4. Smelting: the recipes of type smelting, blasting and smoking of its data
 * pack (data/minecraft/recipes). Fuel: the table of the game's furnace, as listed in the Minecraft Wiki, "Smelting",
 * section "Fuel". minecraft-data has neither.
 */

const COLOURS = [
  'white', 'orange', 'magenta', 'light_blue', 'yellow', 'lime', 'pink', 'gray', 'light_gray', 'cyan',
  'purple', 'blue', 'brown', 'green', 'red', 'black',
]
const ORES = {
  iron_ingot: ['raw_iron', 'iron_ore', 'deepslate_iron_ore'],
  gold_ingot: ['raw_gold', 'gold_ore', 'deepslate_gold_ore', 'nether_gold_ore'],
  copper_ingot: ['raw_copper', 'copper_ore', 'deepslate_copper_ore'],
  coal: ['coal_ore', 'deepslate_coal_ore'],
  diamond: ['diamond_ore', 'deepslate_diamond_ore'],
  emerald: ['emerald_ore', 'deepslate_emerald_ore'],
  lapis_lazuli: ['lapis_ore', 'deepslate_lapis_ore'],
  redstone: ['redstone_ore', 'deepslate_redstone_ore'],
  quartz: ['nether_quartz_ore'],
  netherite_scrap: ['ancient_debris'],
}
const TOOLS = ['pickaxe', 'shovel', 'axe', 'hoe', 'sword']
const ARMOUR = ['helmet', 'chestplate', 'leggings', 'boots']
const FOOD = {
  beef: 'cooked_beef', chicken: 'cooked_chicken', cod: 'cooked_cod', kelp: 'dried_kelp', mutton: 'cooked_mutton',
  porkchop: 'cooked_porkchop', potato: 'baked_potato', rabbit: 'cooked_rabbit', salmon: 'cooked_salmon',
}
const OTHER = {
  sand: 'glass', red_sand: 'glass', cobblestone: 'stone', stone: 'smooth_stone', sandstone: 'smooth_sandstone',
  red_sandstone: 'smooth_red_sandstone', quartz_block: 'smooth_quartz', basalt: 'smooth_basalt',
  cobbled_deepslate: 'deepslate', stone_bricks: 'cracked_stone_bricks', nether_bricks: 'cracked_nether_bricks',
  deepslate_bricks: 'cracked_deepslate_bricks', deepslate_tiles: 'cracked_deepslate_tiles',
  polished_blackstone_bricks: 'cracked_polished_blackstone_bricks', clay_ball: 'brick', netherrack: 'nether_brick',
  clay: 'terracotta', cactus: 'green_dye', sea_pickle: 'lime_dye', wet_sponge: 'sponge',
  chorus_fruit: 'popped_chorus_fruit',
}
const WOODS = 'oak|spruce|birch|jungle|acacia|dark_oak|mangrove|cherry'
const CHARCOAL = new RegExp(`^(stripped_)?(${WOODS})_(log|wood)$`)

const inverted = (groups) => Object.fromEntries(
  Object.entries(groups).flatMap(([result, sources]) => sources.map((source) => [source, result])))
const pieces = (material, kinds) => kinds.map((kind) => `${material}_${kind}`)

const METAL = {
  ...inverted(ORES),
  ...inverted({
    iron_nugget: [...pieces('iron', [...TOOLS, ...ARMOUR, 'horse_armor']), ...pieces('chainmail', ARMOUR)],
    gold_nugget: pieces('golden', [...TOOLS, ...ARMOUR, 'horse_armor']),
  }),
}
const GLAZED = Object.fromEntries(COLOURS.map((colour) => [`${colour}_terracotta`, `${colour}_glazed_terracotta`]))

const KINDS = {
  furnace: { table: { ...METAL, ...FOOD, ...OTHER, ...GLAZED }, ticks: 200 },
  blast_furnace: { table: METAL, ticks: 100 },
  smoker: { table: FOOD, ticks: 100 },
}

/** Return the name of a kind of furnace's product for an item, or undefined. */
function resultOf (kind, name) {
  if (kind === 'furnace' && CHARCOAL.test(name)) return 'charcoal'
  return Object.hasOwn(KINDS[kind].table, name) ? KINDS[kind].table[name] : undefined
}

/** Return the number of ticks that a kind of furnace takes for one item. */
const ticksOf = (kind) => KINDS[kind].ticks

const FUELS = [
  [/^lava_bucket$/, 20000],
  [/^coal_block$/, 16000],
  [/^dried_kelp_block$/, 4001],
  [/^blaze_rod$/, 2400],
  [/^(coal|charcoal)$/, 1600],
  [/_(chest_)?boat$|_(chest_)?raft$/, 1200],
  [/^(?!crimson|warped).*_hanging_sign$/, 800],
  [/^(bamboo|scaffolding)$/, 50],
  [/^(?!moss).*_carpet$/, 67],
  [/_wool$|^(?!stone|polished|crimson|warped).*_button$|_sapling$|^mangrove_propagule$|^(stick|bowl|azalea|flowering_azalea|dead_bush)$/, 100],
  [new RegExp(`^(${WOODS}|bamboo|bamboo_mosaic)_slab$`), 150],
  [new RegExp(`^wooden_|^(${WOODS}|bamboo)_(sign|door)$`), 200],
  [new RegExp(`^(stripped_)?(${WOODS})_(log|wood)$|^(stripped_)?bamboo_block$|^mangrove_roots$|^bamboo_mosaic(_stairs)?$`), 300],
  [new RegExp(`^(${WOODS}|bamboo)_(planks|stairs|trapdoor|pressure_plate|fence|fence_gate)$`), 300],
  [/^(note_block|bookshelf|chiseled_bookshelf|lectern|jukebox|chest|trapped_chest|crafting_table|daylight_detector|barrel)$/, 300],
  [/^(cartography_table|fletching_table|smithing_table|loom|composter|bow|crossbow|fishing_rod|ladder)$|_banner$/, 300],
]

/** Return the number of ticks that an item burns; 0 for an item that does not burn. */
function burnTicks (name) {
  return FUELS.find(([pattern]) => pattern.test(name))?.[1] ?? 0
}

module.exports = { KINDS: Object.keys(KINDS), COLOURS, resultOf, ticksOf, burnTicks }
