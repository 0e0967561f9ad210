'use strict'
/** Blocks of a region in the server's world, with invisible walls around the box. */
const { Vec3 } = require('vec3')
const { CHUNK } = require('./allotment')

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
 * Build the columns of a region in the world.
 * @param {object} serv
 * @param {import('./region').Region} region
 * @param {Int32Array} states states of the box, in its array order
 */
function buildColumns (serv, region, states) {
  const Chunk = require('prismarine-chunk')(serv.registry)
  for (const [x, z] of region.columns) {
    serv.overworld.sync.setColumn(x, z, new Chunk({ minY: serv.minY, worldHeight: serv.worldHeight }))
  }
  const wall = serv.registry.blocksByName.barrier.defaultState
  const { box, origin } = region
  box.grown().forEach((x, y, z) => {
    const state = box.contains(x, y, z) ? states[box.index(x, y, z)] : wall
    if (state <= 0 || y < serv.minY || y >= serv.minY + serv.worldHeight) return
    setRaw(serv, x + origin.x, y, z + origin.z, state)
    if (state !== wall) serv.containers.stand(region.toServer([x, y, z]))
  })
}

function setRaw (serv, x, y, z, state) {
  const column = serv.overworld.sync.getColumn(x >> 4, z >> 4)
  column.setBlockStateId({ x: x & 15, y, z: z & 15 }, state)
}

/** Return the block states of a region's box. @returns {Int32Array} */
function readStates (serv, region) {
  const { box, origin } = region
  const states = new Int32Array(box.size)
  box.forEach((x, y, z, index) => {
    const column = serv.overworld.sync.getColumn((x + origin.x) >> 4, (z + origin.z) >> 4)
    states[index] = column.getBlockStateId({ x: (x + origin.x) & 15, y, z: (z + origin.z) & 15 })
  })
  return states
}

function dropColumns (serv, region) {
  for (const [x, z] of region.columns) serv.overworld.sync.unloadColumn(x, z)
}

/** Return the block state at a server position. @returns {number} */
function stateAt (serv, position) {
  return serv.overworld.sync.getBlockStateId(new Vec3(position.x, position.y, position.z))
}

module.exports = { buildColumns, columnsOf, dropColumns, readStates, stateAt }
