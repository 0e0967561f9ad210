'use strict'
// Effects of using and breaking blocks by hand, for worlds without a server. They are computed from the server
// plugins' own rules. world/handling.py reads the file.

const { dropsOf } = require('./src/server/plugins/lib/drops')
const { pressedTicks } = require('./src/server/plugins/lib/buttons')

const FORMAT = 1
// Blocks of several parts, blocks that support others or that fall, and containers.
const NOT_ALONE = /_door$|_bed$|chest$|furnace$|smoker$|shulker_box$|barrel$|^(sand|red_sand|suspicious_sand|gravel|suspicious_gravel|anvil)$|concrete_powder$/

/** Return the drops of a block; null if they depend on its state or on chance. */
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

/**
 * Return with which tools a block can be broken by hand, and its drops; null if it cannot or the drops are uncertain.
 */
function breaking (registry, Block, block) {
  if (!block.diggable || block.name === 'air' || NOT_ALONE.test(block.name)) return null
  const tools = Object.keys(block.harvestTools ?? {}).map(Number)
  const tool = tools.length === 0 ? null : { type: tools[0], enchants: [] }
  const drops = sureDrops(registry, Block, block, tool)
  return drops === null ? null : { tools: tools.map(id => registry.items[id].name).sort(), drops }
}

/** Return the handling data by block name, as plain data. @returns {object} */
function buildHandling (version) {
  const registry = require('prismarine-registry')(version)
  const Block = require('prismarine-block')(registry)
  const broken = registry.blocksArray.map(block => [block.name, breaking(registry, Block, block)]).filter(([, how]) => how !== null)
  const pressed = registry.blocksArray.map(({ name }) => [name, pressedTicks(name)]).filter(([, ticks]) => ticks > 0)
  return { format: FORMAT, minecraft: version, breaking: Object.fromEntries(broken), pressed: Object.fromEntries(pressed) }
}

module.exports = { buildHandling }
