'use strict'
/**
 * Cached block objects. A world is asked for blocks thousands of times a tick, and `new Block` computes every property
 * anew. This module computes a block once per state, and returns the same object as long as its position keeps that
 * state.
 */

const { Vec3 } = require('vec3')

// Number of blocks of a chunk column at one height.
const LAYER = 256
// Bits of all sections of a column.
const ALL = -1

/** Make the chunk columns and worlds of a version cache the blocks that they return. A second call has no effect. */
function rememberBlocks (registry) {
  const Chunk = require('prismarine-chunk')(registry)
  const World = require('prismarine-world')(registry)
  if ('remembered' in Chunk.prototype) return
  rememberColumns(World)
  quicken(Object.getPrototypeOf(new World(null).sync))
  rememberIn(Chunk, maker(registry))
}

/**
 * Return a function that makes blocks without a position. It computes the properties of each state once.
 * @returns {(stateId: number) => object}
 */
function maker (registry) {
  const Block = require('prismarine-block')(registry)
  const copy = copier(Block)
  const blocksByState = new Map()
  return stateId => {
    let block = blocksByState.get(stateId)
    if (block === undefined) {
      block = Block.fromStateId(stateId, 0)
      blocksByState.set(stateId, block)
    }
    return copy(block)
  }
}

/** Make `getBlock` of a column return the cached block as long as the position keeps its state. */
function rememberIn (Chunk, make) {
  const { setBlockStateId, setBlockEntity, load } = Chunk.prototype
  Object.assign(Chunk.prototype, {
    remembered: null,
    hasEntities: false,
    // Bits of the sections that other columns may use, too; such a section is copied before it changes.
    lent: 0,
    /**
     * Return a column with the same blocks that can change without this one. The two share each section until one of
     * them changes it, so that a copy costs little.
     */
    copy () {
      this.lent = ALL
      const { sections, biomes } = this
      return Object.assign(Object.create(Chunk.prototype), this, {
        sections: [...sections], biomes: [...biomes], blockEntities: {}, remembered: null, hasEntities: false
      })
    },
    getBlock (place) {
      this.remembered ??= []
      const layer = (this.remembered[place.y - this.minY] ??= new Array(LAYER).fill(null))
      const block = (layer[(place.z << 4) | place.x] ??= make(this.getBlockStateId(place)))
      if (this.hasEntities) block.entity = this.getBlockEntity(place)
      return block
    },
    /** Return the state of all blocks in the section at a height; null if they differ. @returns {number | null} */
    onlyState (y) {
      return this.sections[(y - this.minY) >> 4].data.value ?? null
    },
    // Do not change a block that was returned earlier: it shows what its caller saw then.
    setBlockStateId (place, stateId) {
      const layer = this.remembered?.[place.y - this.minY]
      if (layer) layer[(place.z << 4) | place.x] = null
      if (this.lent !== 0) this.keep((place.y - this.minY) >> 4)
      return setBlockStateId.call(this, place, stateId)
    },
    /** Make a section this column's own. */
    keep (index) {
      if (this.sections[index] === undefined || (this.lent & (1 << index)) === 0) return
      this.lent &= ~(1 << index)
      this.sections[index] = sectionLike(this.sections[index])
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

/** Return a copy of a section that can change without it. */
function sectionLike (section) {
  const copy = original => Object.assign(Object.create(Object.getPrototypeOf(original)), original)
  const made = copy(section)
  made.data = copy(section.data)
  if (made.data.palette !== undefined) made.data.palette = made.palette = [...section.data.palette]
  if (made.data.data !== undefined) {
    made.data.data = copy(section.data.data)
    made.data.data.data = section.data.data.data.slice()
  }
  return made
}

/**
 * Cache the last columns, four adjacent ones, because most queries ask for them again. A world with a function `ground`
 * gets from it, when they are first needed, the columns that were never set.
 */
function rememberColumns (World) {
  const { getLoadedColumn, setLoadedColumn, unloadColumn } = World.prototype
  const nothing = () => ({ x: 0, z: 0, column: undefined })
  Object.assign(World.prototype, {
    lately: null,
    ground: null,
    getLoadedColumn (x, z) {
      this.lately ??= [nothing(), nothing(), nothing(), nothing()]
      const slot = this.lately[(x & 1) << 1 | (z & 1)]
      if (slot.x !== x || slot.z !== z || slot.column === undefined) {
        slot.column = getLoadedColumn.call(this, x, z) ?? this.begun(x, z)
        slot.x = x
        slot.z = z
      }
      return slot.column
    },
    /** Return a column that was never set; undefined if there is none. */
    begun (x, z) {
      const column = this.ground?.(x, z)
      if (column !== undefined) this.columns[`${x},${z}`] = column
      return column
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

/**
 * Replace `getBlock` of a synchronous world by a version that allocates fewer objects, and add `blockIn`, the same for
 * integer coordinates.
 */
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

// Keep the most used properties close together in memory, and define from the start the properties that pathfinder and
// bots add later.
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
 * Return a function that copies blocks with one common layout. If properties are added one by one, as by
 * Object.assign, V8 stores the object as a hash table, which is several times slower to read.
 */
function copier (Block) {
  return original => ({ __proto__: Block.prototype, ...LAYOUT, ...original, computedStates: {} })
}

module.exports = { maker, rememberBlocks }
