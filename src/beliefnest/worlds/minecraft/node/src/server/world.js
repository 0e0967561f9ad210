'use strict'
/**
 * The server's only world: it contains only the columns of regions, never unloads and never saves them.
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
  // Grounds of the regions, from which columns are made when they are first needed.
  serv.grounds = new Set()
  serv.overworld.ground = (chunkX, chunkZ) => {
    for (const ground of serv.grounds) {
      if (!ground.has(chunkX, chunkZ)) continue
      ground.made.push([chunkX, chunkZ])
      return ground.column(chunkX, chunkZ)
    }
    return undefined
  }
  serv.dimensionNames = { 0: 'minecraft:overworld' }
  serv.hashedSeed = [0, 0]
  // flying-squid updates the neighbours of changed blocks to run redstone, which we do not use.
  serv.updateBlock = () => {}
  serv.notifyNeighborsOfStateChange = () => {}
}

module.exports.player = (player, serv) => {
  player.loadedChunks = {}
  player.ground = null

  /** Send the columns of the world. A bot of this process gets each when it first asks for it. */
  player.sendColumns = columns => {
    if (player._client instanceof ServerEnd) {
      player.ground = serv.region.ground
      player._client.write('ground', { source: player.ground.source(serv.overworld), bottom: player.ground.bottom })
    } else {
      for (const [x, z] of columns) player.sendColumn(x, z)
    }
  }

  player.sendColumn = (chunkX, chunkZ) => {
    player.loadedChunks[`${chunkX},${chunkZ}`] = 1
    player._client.write('map_chunk', columnPacket(serv.overworld.sync.getColumn(chunkX, chunkZ), chunkX, chunkZ))
  }

  /** Return true if the player has the column of a position, so that changes there are sent. */
  player.hasColumn = ({ x, z }) => {
    const [chunkX, chunkZ] = [Math.floor(x / 16), Math.floor(z / 16)]
    return `${chunkX},${chunkZ}` in player.loadedChunks || (player.ground?.has(chunkX, chunkZ) ?? false)
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
