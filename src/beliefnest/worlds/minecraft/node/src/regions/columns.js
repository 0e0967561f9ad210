'use strict'
/** Blocks of a region in the server's world, with invisible walls around the box. */
const { Vec3 } = require('vec3')
const { CHUNK } = require('./allotment')
const { Box } = require('./box')

/**
 * Return the chunk numbers (server) of a region's columns, with one more column on each side of its walls.
 * @returns {[number, number][]}
 */
function columnsOf (box, origin) {
  const range = (low, high, offset) => {
    const first = Math.floor((low - 1 + offset) / CHUNK)
    const last = Math.floor((high + 1 + offset) / CHUNK)
    return Array.from({ length: last - first + 1 }, (_, i) => first + i)
  }
  const xs = range(box.low[0], box.high[0], origin.x)
  const zs = range(box.low[2], box.high[2], origin.z)
  return xs.flatMap(x => zs.map(z => [x, z]))
}

/**
 * Build the columns of a region in the world. A new column is all air, so only other blocks are set.
 * @param {object} serv
 * @param {import('./region').Region} region
 * @param {Int32Array} states states of the box, in its array order
 */
function buildColumns (serv, region, states) {
  const Chunk = require('prismarine-chunk')(serv.registry)
  const air = new Chunk({ minY: serv.minY, worldHeight: serv.worldHeight })
  for (const [x, z] of region.columns) serv.overworld.sync.setColumn(x, z, air.copy())
  buildWalls(serv, region)
  const holdsItems = new Map()
  eachColumn(region, (chunkX, chunkZ, part) => {
    const column = serv.overworld.sync.getColumn(chunkX, chunkZ)
    eachRow(part, (x, y, z, length) => {
      const first = region.box.index(x, y, z)
      for (let i = 0; i < length; i++) {
        const state = states[first + i]
        if (state <= 0) continue
        column.setBlockStateId(within(region, x, y, z + i), state)
        if (!holdsItems.has(state)) holdsItems.set(state, serv.containers.holds(state))
        if (holdsItems.get(state)) serv.containers.stand(region.toServer([x, y, z + i]))
      }
    })
  })
}

/** Build the invisible walls around the box. */
function buildWalls (serv, region) {
  const wall = serv.registry.blocksByName.barrier.defaultState
  const { low, high } = region.box.grown()
  for (const axis of [0, 1, 2]) {
    for (const side of [low, high]) {
      if (axis === 1 && (side[1] < serv.minY || side[1] >= serv.minY + serv.worldHeight)) continue
      const face = new Box(low.with(axis, side[axis]), high.with(axis, side[axis]))
      face.forEach((x, y, z) => {
        if (y < serv.minY || y >= serv.minY + serv.worldHeight) return
        const column = serv.overworld.sync.getColumn((x + region.origin.x) >> 4, (z + region.origin.z) >> 4)
        column.setBlockStateId(within(region, x, y, z), wall)
      })
    }
  }
}

/** Return the block states of a region's box. @returns {Int32Array} */
function readStates (serv, region) {
  const { box } = region
  const states = new Int32Array(box.size)
  eachColumn(region, (chunkX, chunkZ, part) => {
    const column = serv.overworld.sync.getColumn(chunkX, chunkZ)
    for (const layer of layersOf(part)) {
      const only = column.onlyState(layer.low[1])
      if (only === 0) continue
      eachRow(layer, (x, y, z, length) => {
        const first = box.index(x, y, z)
        if (only !== null) return states.fill(only, first, first + length)
        for (let i = 0; i < length; i++) states[first + i] = column.getBlockStateId(within(region, x, y, z + i))
      })
    }
  })
  return states
}

/** Call `visit(chunkX, chunkZ, part)` for every column that contains a part of the box, with this part. */
function eachColumn ({ box: { low, high }, origin, columns }, visit) {
  for (const [chunkX, chunkZ] of columns) {
    const [x, z] = [chunkX * CHUNK - origin.x, chunkZ * CHUNK - origin.z]
    const from = [Math.max(low[0], x), low[1], Math.max(low[2], z)]
    const to = [Math.min(high[0], x + CHUNK - 1), high[1], Math.min(high[2], z + CHUNK - 1)]
    if (from[0] <= to[0] && from[2] <= to[2]) visit(chunkX, chunkZ, new Box(from, to))
  }
}

/** Call `visit(x, y, z, length)` for every row of a box along z, with the position of its first block. */
function eachRow ({ low, high }, visit) {
  for (let x = low[0]; x <= high[0]; x++) {
    for (let y = low[1]; y <= high[1]; y++) visit(x, y, low[2], high[2] - low[2] + 1)
  }
}

/** Return the parts of a box in each section of chunks, which is 16 blocks high. @returns {Box[]} */
function layersOf ({ low, high }) {
  const [first, last] = [low[1] >> 4, high[1] >> 4]
  return Array.from({ length: last - first + 1 }, (_, i) => new Box(
    low.with(1, Math.max(low[1], (first + i) * CHUNK)), high.with(1, Math.min(high[1], (first + i) * CHUNK + CHUNK - 1))))
}

/** Return the position of a block within its column of the server's world. */
function within ({ origin }, x, y, z) {
  return { x: (x + origin.x) & 15, y, z: (z + origin.z) & 15 }
}

function dropColumns (serv, region) {
  for (const [x, z] of region.columns) serv.overworld.sync.unloadColumn(x, z)
}

/** Return the block state at a server position. @returns {number} */
function stateAt (serv, position) {
  return serv.overworld.sync.getBlockStateId(new Vec3(position.x, position.y, position.z))
}

module.exports = { buildColumns, columnsOf, dropColumns, readStates, stateAt }
