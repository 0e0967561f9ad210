'use strict'
/**
 * Block objects, quickly. Worlds are asked for blocks thousands of times a tick, and
 * `new Block` works out every property anew; here a block is worked out once per state and
 * handed out again as long as its place keeps that state.
 */

const { Vec3 } = require('vec3')

// Blocks of a column at one height.
const LAYER = 256

/** Makes the chunk columns and worlds of a version remember what they were asked for; once is enough. */
function rememberBlocks (registry) {
  const Block = require('prismarine-block')(registry)
  const Chunk = require('prismarine-chunk')(registry)
  const World = require('prismarine-world')(registry)
  if ('remembered' in Chunk.prototype) return
  rememberColumns(World)
  quicken(Object.getPrototypeOf(new World(null).sync))
  const copy = copier(Block)
  const known = new Map()

  function make (stateId) {
    let block = known.get(stateId)
    if (block === undefined) {
      block = Block.fromStateId(stateId, 0)
      known.set(stateId, block)
    }
    return copy(block)
  }

  rememberIn(Chunk, make)
}

/** Makes `getBlock` of a column find again what it made, as long as the place keeps its state. */
function rememberIn (Chunk, make) {
  const { setBlockStateId, load } = Chunk.prototype
  Object.assign(Chunk.prototype, {
    remembered: null,
    getBlock (place) {
      this.remembered ??= []
      const layer = (this.remembered[place.y - this.minY] ??= new Array(LAYER).fill(null))
      const index = (place.z << 4) | place.x
      const block = (layer[index] ??= make(this.getBlockStateId(place)))
      if (hasAny(this.blockEntities)) block.entity = this.getBlockEntity(place)
      return block
    },
    // An object that was handed out is never changed: it stays what was seen then.
    setBlockStateId (place, stateId) {
      const layer = this.remembered?.[place.y - this.minY]
      if (layer) layer[(place.z << 4) | place.x] = null
      return setBlockStateId.call(this, place, stateId)
    },
    load (...data) {
      this.remembered = []
      return load.apply(this, data)
    }
  })
}

function hasAny (entries) {
  for (const key in entries) return key !== undefined
  return false
}

/** The column asked for last is asked for again most of the time. */
function rememberColumns (World) {
  const { getLoadedColumn, setLoadedColumn, unloadColumn } = World.prototype
  Object.assign(World.prototype, {
    getLoadedColumn (x, z) {
      if (this.lastX !== x || this.lastZ !== z || this.lastColumn === undefined) {
        this.lastColumn = getLoadedColumn.call(this, x, z)
        this.lastX = x
        this.lastZ = z
      }
      return this.lastColumn
    },
    setLoadedColumn (x, z, ...rest) {
      this.lastColumn = undefined
      return setLoadedColumn.call(this, x, z, ...rest)
    },
    unloadColumn (x, z) {
      this.lastColumn = undefined
      return unloadColumn.call(this, x, z)
    }
  })
}

/** `getBlock` of a world's synchronous side, with fewer objects made on the way. */
function quicken (prototype) {
  prototype.getBlock = function getBlock (place) {
    const x = Math.floor(place.x)
    const y = Math.floor(place.y)
    const z = Math.floor(place.z)
    const column = this.async.getLoadedColumn(x >> 4, z >> 4)
    if (!column) return null
    const block = column.getBlock({ x: x & 15, y, z: z & 15 })
    const { position } = block
    if (position === null || position.x !== x || position.y !== y || position.z !== z) {
      block.position = new Vec3(x, y, z)
    }
    return block
  }
}

/** Copies all blocks the same way, so that they share one layout in memory. */
function copier (Block) {
  return original => {
    const block = Object.assign(Object.create(Block.prototype), original)
    block.computedStates = {}
    block.entity = undefined
    return block
  }
}

module.exports = { rememberBlocks }
