'use strict'
// Writer of the facts about a Minecraft version that Python needs: `node registry.js OUTDIR`. The data is
// minecraft-data's (MIT). world/registry.py reads the file.

const fs = require('node:fs')
const path = require('node:path')
const { encode } = require('@msgpack/msgpack')
const minecraftData = require('minecraft-data')
const { minecraft: MINECRAFT_VERSION } = require('./src/versions')

const FORMAT = 1

/** Return the texts of a property's values, in the order in which state ids count them. */
function propertyValues (property) {
  // The protocol counts `true` before `false`; minecraft-data lists no values of booleans.
  if (property.type === 'bool') return ['true', 'false']
  if (property.values?.length !== property.num_values) {
    throw new Error(`property ${property.name} should list ${property.num_values} values`)
  }
  return property.values.map(String)
}

/** Table of distinct collision shapes, numbered in order of first use. */
class ShapeTable {
  constructor () {
    this.shapes = []
    this.numbers = new Map()
  }

  numberOf (boxes) {
    const key = JSON.stringify(boxes)
    if (!this.numbers.has(key)) {
      this.numbers.set(key, this.shapes.length)
      this.shapes.push(boxes)
    }
    return this.numbers.get(key)
  }
}

/** Return the shape numbers of a block: one for all states, or one for each state. */
function blockShapes (block, collision, table) {
  const states = block.maxStateId - block.minStateId + 1
  const shapes = [collision.blocks[block.name]].flat()
  if (shapes.length !== 1 && shapes.length !== states) {
    throw new Error(`${block.name} has ${states} states and ${shapes.length} collision shapes`)
  }
  const numbers = shapes.map((shape) => table.numberOf(collision.shapes[shape]))
  return new Set(numbers).size === 1 ? numbers.slice(0, 1) : numbers
}

/** Return the registry of one Minecraft version as plain data. */
function buildRegistry (version) {
  const data = minecraftData(version)
  const table = new ShapeTable()
  const blocks = data.blocksArray.map((block) => ({
    name: block.name,
    first_state: block.minStateId,
    last_state: block.maxStateId,
    default_state: block.defaultState,
    properties: block.states.map((p) => [p.name, propertyValues(p)]),
    shapes: blockShapes(block, data.blockCollisionShapes, table),
    solid: block.boundingBox === 'block'
  }))
  return {
    format: FORMAT,
    minecraft: version,
    blocks,
    shapes: table.shapes,
    items: data.itemsArray.map((item) => [item.name, item.stackSize])
  }
}

function main (argv) {
  const [outDir] = argv
  if (argv.length !== 1) throw new Error('usage: node registry.js OUTDIR')
  fs.mkdirSync(outDir, { recursive: true })
  const file = path.join(outDir, `registry-${MINECRAFT_VERSION}.msgpack`)
  fs.writeFileSync(file, encode(buildRegistry(MINECRAFT_VERSION)))
}

if (require.main === module) main(process.argv.slice(2))

module.exports = { MINECRAFT_VERSION, buildRegistry }
