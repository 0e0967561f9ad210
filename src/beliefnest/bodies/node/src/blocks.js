'use strict'
/**
 * Block objects, quickly. Worlds are asked for blocks thousands of times a tick, and
 * `new Block` works out every property anew; here a block is worked out once per state and
 * handed out again as long as its place keeps that state.
 */

const { Vec3 } = require('vec3')

// Blocks of a column at one height.
const LAYER = 256

/** Make the chunk columns and worlds of a version remember what they were asked for; once is enough. */
function rememberBlocks (registry) {
  const Chunk = require('prismarine-chunk')(registry)
  const World = require('prismarine-world')(registry)
  if ('remembered' in Chunk.prototype) return
  rememberColumns(World)
  quicken(Object.getPrototypeOf(new World(null).sync))
  rememberIn(Chunk, maker(registry))
}

/** @returns {(stateId: number) => object} makes blocks without a position; what a state is like is worked out once */
function maker (registry) {
  const Block = require('prismarine-block')(registry)
  const copy = copier(Block)
  const known = new Map()
  return stateId => {
    let block = known.get(stateId)
    if (block === undefined) {
      block = Block.fromStateId(stateId, 0)
      known.set(stateId, block)
    }
    return copy(block)
  }
}

/** Make `getBlock` of a column find again what it made, as long as the place keeps its state. */
function rememberIn (Chunk, make) {
  const { setBlockStateId, setBlockEntity, load } = Chunk.prototype
  Object.assign(Chunk.prototype, {
    remembered: null,
    hasEntities: false,
    getBlock (place) {
      this.remembered ??= []
      const layer = (this.remembered[place.y - this.minY] ??= new Array(LAYER).fill(null))
      const block = (layer[(place.z << 4) | place.x] ??= make(this.getBlockStateId(place)))
      if (this.hasEntities) block.entity = this.getBlockEntity(place)
      return block
    },
    // An object that was handed out is never changed: it stays what was seen then.
    setBlockStateId (place, stateId) {
      const layer = this.remembered?.[place.y - this.minY]
      if (layer) layer[(place.z << 4) | place.x] = null
      return setBlockStateId.call(this, place, stateId)
    },
    setBlockEntity (place, tag) {
      this.hasEntities = true
      return setBlockEntity.call(this, place, tag)
    },
    load (...data) {
      this.remembered = []
      return load.apply(this, data)
    }
  })
}

/** Columns asked for last, the nearest four of them side by side, are asked for again most of the time. */
function rememberColumns (World) {
  const { getLoadedColumn, setLoadedColumn, unloadColumn } = World.prototype
  const nothing = () => ({ x: 0, z: 0, column: undefined })
  Object.assign(World.prototype, {
    lately: null,
    getLoadedColumn (x, z) {
      this.lately ??= [nothing(), nothing(), nothing(), nothing()]
      const known = this.lately[(x & 1) << 1 | (z & 1)]
      if (known.x !== x || known.z !== z || known.column === undefined) {
        known.column = getLoadedColumn.call(this, x, z)
        known.x = x
        known.z = z
      }
      return known.column
    },
    setLoadedColumn (x, z, ...rest) {
      this.lately = null
      return setLoadedColumn.call(this, x, z, ...rest)
    },
    unloadColumn (x, z) {
      this.lately = null
      return unloadColumn.call(this, x, z)
    }
  })
}

/** `getBlock` of a world's synchronous side, with fewer objects made on the way, and the same by whole numbers. */
function quicken (prototype) {
  prototype.blockIn = function blockIn (x, y, z) {
    const column = this.async.getLoadedColumn(x >> 4, z >> 4)
    if (!column) return null
    const block = column.getBlock({ x: x & 15, y, z: z & 15 })
    block.position ??= new Vec3(x, y, z)
    return block
  }
  prototype.getBlock = function getBlock ({ x, y, z }) {
    return this.blockIn(Math.floor(x), Math.floor(y), Math.floor(z))
  }
}

// What is read most lies together in memory; what the pathfinder and the bots note is there from the start.
const LAYOUT = {
  position: null,
  type: undefined,
  shapes: undefined,
  boundingBox: undefined,
  notedBy: undefined,
  safe: undefined,
  physical: undefined,
  liquid: undefined,
  height: undefined,
  top: undefined,
  climbable: undefined,
  replaceable: undefined,
  canFall: undefined,
  openable: undefined,
  entity: undefined,
  painting: undefined
}

/**
 * Copy all blocks the same way, so that they share one layout. V8 keeps an object that gets many properties
 * one by one, as from Object.assign, in a hash table, several times slower to read.
 */
function copier (Block) {
  return original => ({ __proto__: Block.prototype, ...LAYOUT, ...original, computedStates: {} })
}

module.exports = { maker, rememberBlocks }
