'use strict'
/**
 * Columns of a region as they were when it was made: the blocks of its box, with invisible walls around it. A column is
 * made when somebody first asks for it. Columns with the same blocks are copies of one, whose sections they share until
 * they change.
 */
const { CHUNK } = require('./allotment')
const { Box } = require('./box')

/** Return the first and the last chunk numbers (server), x and z, of the columns of a box with walls. */
function spanOf (box, origin) {
  const { low, high } = box.grown()
  return { first: [(low[0] + origin.x) >> 4, (low[2] + origin.z) >> 4], last: [(high[0] + origin.x) >> 4, (high[2] + origin.z) >> 4] }
}

/** Return the chunk numbers (server) of the columns of a box with walls. @returns {[number, number][]} */
function columnsOf (box, origin) {
  const { first, last } = spanOf(box, origin)
  const range = axis => Array.from({ length: last[axis] - first[axis] + 1 }, (_, i) => first[axis] + i)
  return range(0).flatMap(x => range(1).map(z => [x, z]))
}

class Ground {
  /**
   * @param {object} serv
   * @param {import('./place').Place} region
   * @param {import('./terrain').Terrain} terrain blocks of its box; unknown ones become air
   * @param {boolean} [isWalled] false if there are no walls
   */
  constructor (serv, { box, origin }, terrain, isWalled = true) {
    const Chunk = require('prismarine-chunk')(serv.registry)
    this.box = box
    this.origin = origin
    this.terrain = terrain
    this.wall = isWalled ? serv.registry.blocksByName.barrier.defaultState : null
    this.heights = [serv.minY, serv.minY + serv.worldHeight - 1]
    this.air = new Chunk({ minY: serv.minY, worldHeight: serv.worldHeight })
    this.empty = terrain.chunks.map(states => states.every(state => state <= 0))
    this.span = spanOf(box, origin)
    // One column of each kind, by key.
    this.kinds = new Map()
    // Columns that exist in the server's world, as [x, z].
    this.made = []
  }

  /** Height of the lowest blocks, those of the walls; below them is only air. */
  get bottom () {
    return this.box.grown().low[1]
  }

  /** Return true if a column of the server has a part of the box or of its walls. */
  has (chunkX, chunkZ) {
    const { first, last } = this.span
    return chunkX >= first[0] && chunkX <= last[0] && chunkZ >= first[1] && chunkZ <= last[1]
  }

  /** Return a new column as it was when the region was made; undefined if there is none. */
  column (chunkX, chunkZ) {
    if (!this.has(chunkX, chunkZ)) return undefined
    const key = this.keyOf(chunkX, chunkZ)
    if (!this.kinds.has(key)) this.kinds.set(key, this.build(chunkX, chunkZ))
    return this.kinds.get(key).copy()
  }

  /**
   * Return the function from which a bot that joins now gets columns, each once: copies of those that exist in the
   * server's world, and for all others those that the region began with. Later changes are sent to the bot.
   * @param {object} world the server's world
   * @returns {(chunkX: number, chunkZ: number) => object | undefined}
   */
  source (world) {
    const present = new Map(this.made.map(([x, z]) => [`${x},${z}`, world.sync.getColumn(x, z).copy()]))
    return (x, z) => present.get(`${x},${z}`) ?? this.column(x, z)
  }

  /** Return the part of the box in a column (server); null if there is none. @returns {Box | null} */
  part (box, chunkX, chunkZ) {
    const [x, z] = [chunkX * CHUNK - this.origin.x, chunkZ * CHUNK - this.origin.z]
    const from = [Math.max(box.low[0], x), box.low[1], Math.max(box.low[2], z)]
    const to = [Math.min(box.high[0], x + CHUNK - 1), box.high[1], Math.min(box.high[2], z + CHUNK - 1)]
    return from[0] <= to[0] && from[2] <= to[2] ? new Box(from, to) : null
  }

  /** Return a text that is the same for columns with the same blocks. */
  keyOf (chunkX, chunkZ) {
    if (this.terrain.isOne) return `${chunkX},${chunkZ}`
    const walled = this.part(this.box.grown(), chunkX, chunkZ)
    const edges = [walled.low[0] + this.origin.x, walled.low[2] + this.origin.z].map(value => value & 15)
    const rows = []
    const part = this.part(this.box, chunkX, chunkZ)
    if (part !== null) this.terrain.eachChunk(part, row => rows.push(row))
    return [...edges, walled.shape[0], walled.shape[2], part?.shape[0], part?.shape[2], ...rows].join()
  }

  build (chunkX, chunkZ) {
    const column = this.air.copy()
    if (this.wall !== null) this.buildWalls(column, this.part(this.box.grown(), chunkX, chunkZ))
    const part = this.part(this.box, chunkX, chunkZ)
    if (part === null) return column
    const { x: x0, z: z0 } = this.origin
    const place = { x: 0, y: 0, z: 0 }
    this.terrain.eachChunk(part, (row, from, to) => {
      if (this.empty[row]) return
      this.terrain.eachBlock(row, from, to, (x, y, z, state) => {
        place.x = (x + x0) & 15
        place.y = y
        place.z = (z + z0) & 15
        column.setBlockStateId(place, state)
      })
    })
    return column
  }

  /** Build the walls in a column; `part` is its part of the box with the walls. */
  buildWalls (column, part) {
    const { low, high } = this.box.grown()
    const [bottom, top] = [Math.max(low[1], this.heights[0]), Math.min(high[1], this.heights[1])]
    const put = (x, y, z) => column.setBlockStateId({ x: (x + this.origin.x) & 15, y, z: (z + this.origin.z) & 15 }, this.wall)
    for (let x = part.low[0]; x <= part.high[0]; x++) {
      for (let z = part.low[2]; z <= part.high[2]; z++) {
        const isSide = x === low[0] || x === high[0] || z === low[2] || z === high[2]
        for (let y = bottom; isSide && y <= top; y++) put(x, y, z)
        for (const y of [low[1], high[1]]) if (!isSide && y >= bottom && y <= top) put(x, y, z)
      }
    }
  }
}

module.exports = { columnsOf, Ground }
