'use strict'
// What comes of using and breaking blocks by hand, for worlds without a server: taken from the rules of the server's own
// plugins. The file's form is read by world/handling.py.

const { dropsOf } = require('./src/server/plugins/lib/drops')
const { pressedTicks } = require('./src/server/plugins/lib/buttons')

const FORMAT = 1
// Blocks of several parts, those that others hang on or that fall, and those that hold something.
const NOT_ALONE = /_door$|_bed$|chest$|furnace$|smoker$|shulker_box$|barrel$|^(sand|red_sand|suspicious_sand|gravel|suspicious_gravel|anvil)$|concrete_powder$/

/** What a block in any of its states drops; null where that differs or is left to chance. */
function sureDrops (registry, Block, block, tool) {
  const texts = new Set()
  for (let state = block.minStateId; state <= block.maxStateId; state++) {
    const properties = Block.fromStateId(state, 0).getProperties()
    for (const chance of [0, 0.999999]) {
      texts.add(JSON.stringify(dropsOf(registry, { name: block.name, properties }, tool, () => chance)))
    }
    if (texts.size > 1) return null
  }
  return Object.fromEntries(JSON.parse([...texts][0]).map(({ name, count }) => [name, count]))
}

/** How a block is broken: with which tools something comes of it, and what; null: not by hand, or not for sure. */
function breaking (registry, Block, block) {
  if (!block.diggable || block.name === 'air' || NOT_ALONE.test(block.name)) return null
  const tools = Object.keys(block.harvestTools ?? {}).map(Number)
  const tool = tools.length === 0 ? null : { type: tools[0], enchants: [] }
  const drops = sureDrops(registry, Block, block, tool)
  return drops === null ? null : { tools: tools.map(id => registry.items[id].name).sort(), drops }
}

/** @returns {object} by name of the block, as plain data */
function buildHandling (version) {
  const registry = require('prismarine-registry')(version)
  const Block = require('prismarine-block')(registry)
  const broken = registry.blocksArray.map(block => [block.name, breaking(registry, Block, block)]).filter(([, how]) => how !== null)
  const pressed = registry.blocksArray.map(({ name }) => [name, pressedTicks(name)]).filter(([, ticks]) => ticks > 0)
  return { format: FORMAT, minecraft: version, breaking: Object.fromEntries(broken), pressed: Object.fromEntries(pressed) }
}

module.exports = { buildHandling }
