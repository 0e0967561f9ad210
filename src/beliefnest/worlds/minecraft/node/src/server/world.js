'use strict'
/**
 * The server's only world: it contains only the columns that regions put into it, never unloads and never saves them.
 */
const nbt = require('prismarine-nbt')
const { ServerEnd } = require('../net/transport')

const HEIGHTMAP_LONGS = 36

module.exports.name = 'world'

module.exports.server = serv => {
  const World = require('prismarine-world')(serv.registry)
  const Chunk = require('prismarine-chunk')(serv.registry)
  serv.overworld = new World(() => new Chunk({ minY: serv.minY, worldHeight: serv.worldHeight }))
  serv.overworld.blockEntityData = {}
  serv.dimensionNames = { 0: 'minecraft:overworld' }
  serv.hashedSeed = [0, 0]
  // flying-squid updates the neighbours of changed blocks to run redstone, which we do not use.
  serv.updateBlock = () => {}
  serv.notifyNeighborsOfStateChange = () => {}
}

module.exports.player = (player, serv) => {
  player.loadedChunks = {}

  player.sendColumn = (chunkX, chunkZ) => {
    player.loadedChunks[`${chunkX},${chunkZ}`] = 1
    const column = serv.overworld.sync.getColumn(chunkX, chunkZ)
    player._client.write('map_chunk', player._client instanceof ServerEnd
      ? { x: chunkX, z: chunkZ, column: column.copy() }
      : columnPacket(column, chunkX, chunkZ))
  }
}

/** Export the packet `map_chunk` of a column. */
module.exports.columnPacket = columnPacket

function columnPacket (column, x, z) {
  return {
    x,
    z,
    heightmaps: nbt.comp({
      MOTION_BLOCKING: nbt.longArray(new Array(HEIGHTMAP_LONGS).fill([0, 0]))
    }),
    chunkData: column.dump(),
    blockEntities: [],
    ...column.dumpLight()
  }
}
