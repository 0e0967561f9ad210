'use strict'
/**
 * Drops of mined blocks, from minecraft-data: `drops` of the block, which it always drops, with the counts of its loot
 * table; nothing if the tool in hand cannot harvest it. Where minecraft-data misreads the loot tables (a bonus as a
 * count, limits, no count at all), this module follows the game's own tables.
 */

const DOUBLE_SLAB = 2
/** Minimum and maximum counts without fortune, from data/minecraft/loot_tables/blocks of Java Edition 1.20.4. */
const COUNTS = [
  [/^(deepslate_)?(coal|diamond|emerald|iron|gold)_ore$|^nether_quartz_ore$/, [1, 1]],
  [/^(deepslate_)?copper_ore$/, [2, 5]],
  [/^(deepslate_)?lapis_ore$/, [4, 9]],
  [/^(deepslate_)?redstone_ore$/, [4, 5]],
  [/^nether_gold_ore$/, [2, 6]],
  [/^glowstone$/, [2, 4]],
  [/^melon$/, [3, 7]],
  [/^sea_lantern$/, [2, 3]],
  [/^amethyst_cluster$/, [4, 4]],
  [/^chorus_plant$/, [0, 1]],
]

function countOf ([low, high], random) {
  const least = low ?? 1
  return least + Math.floor(random() * (Math.max(high, least) - least + 1))
}

function slabCount (properties, count) {
  return count === DOUBLE_SLAB && properties.type !== undefined && properties.type !== 'double' ? 1 : count
}

/** Return the entries of a loot table that apply, by silk touch and by a plant's age. */
function applicable (loot, properties, silkTouch) {
  return loot.filter(({ silkTouch: silk, noSilkTouch: noSilk, blockAge }) =>
    !(silk && !silkTouch) && !(noSilk && silkTouch) &&
    (blockAge === undefined || properties.age === blockAge))
}

function sureNames (registry, data, entries, silkTouch) {
  if (silkTouch && entries.some(({ silkTouch: silk }) => silk)) {
    return entries.filter(({ silkTouch: silk }) => silk).map(({ item }) => item)
  }
  const names = data.drops.map((drop) => registry.items[drop].name)
  if (names.length) return [...names, ...entries.filter(({ blockAge }) => blockAge !== undefined).map(({ item }) => item)]
  return entries.length === 1 && entries[0].dropChance === 1 ? [entries[0].item] : []
}

/**
 * Return the drops of a block.
 * @param {object} registry
 * @param {{name, properties}} block
 * @param {object | null} tool prismarine-item in hand
 * @param {() => number} random
 * @returns {{name: string, count: number}[]}
 */
function dropsOf (registry, { name, properties }, tool, random) {
  const data = registry.blocksByName[name]
  if (data.harvestTools && !data.harvestTools[tool?.type]) return []
  const silkTouch = Boolean(tool?.enchants?.some((enchant) => enchant.name === 'silk_touch'))
  const entries = applicable(registry.blockLoot[name]?.drops ?? [], properties, silkTouch)
  const corrected = COUNTS.find(([pattern]) => pattern.test(name))?.[1]
  return [...new Set(sureNames(registry, data, entries, silkTouch))].map((item) => {
    const listed = entries.find((entry) => entry.item === item)?.stackSizeRange ?? [1, 1]
    const range = item === name ? listed : corrected ?? listed
    return { name: item, count: slabCount(properties, countOf(range, random)) }
  }).filter(({ name: item, count }) => item !== 'air' && count > 0)
}

module.exports = { dropsOf }
