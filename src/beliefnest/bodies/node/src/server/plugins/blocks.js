'use strict'

const { EventEmitter } = require('events')
const { blockStates, encode } = require('./lib/states')

/**
 * Blocks, read and written at once. flying-squid's own accessors are asynchronous, so that
 * two acts of one tick could interleave; here an act is done when the call returns.
 *
 * `serv.blocks.on('change', ({position, before, after, player}) => ...)` reports every
 * change of a block state (ids), whoever made it; `player` is set where one did. `update` follows
 * where what is beside the block is to take notice: a door's other half, sand without a hold.
 */
module.exports.server = (serv) => {
  const { registry } = serv
  const { describe, text } = blockStates(registry)
  const blocks = new EventEmitter()
  blocks.setMaxListeners(0)

  /** `{stateId, type, name, shapes, solid, transparent, properties}` of the block there. */
  blocks.at = (position) => describe(serv.overworld.sync.getBlockStateId(position))
  blocks.describe = describe
  blocks.text = text
  /** State id by name and properties. */
  blocks.state = (name, properties = {}) => encode(registry, name, properties)
  /** The state a block has after some of its properties changed. */
  blocks.stateWith = (block, properties) => encode(
    registry, block.name, { ...block.properties, ...properties })

  /** Tell a player what is there, whether or not it changed. */
  blocks.send = (player, position) => player._client.write('block_change', {
    location: position, type: serv.overworld.sync.getBlockStateId(position),
  })

  /** Set a block as it is, and nothing else: what is beside it does not take notice. */
  blocks.put = (position, stateId, player = null) => {
    const before = serv.overworld.sync.getBlockStateId(position)
    if (before === stateId) return null
    serv.overworld.sync.setBlockStateId(position, stateId)
    const column = `${Math.floor(position.x / 16)},${Math.floor(position.z / 16)}`
    for (const other of serv.players) {
      if (other.loadedChunks?.[column]) blocks.send(other, position)
    }
    const change = { position: position.clone(), before, after: stateId, player }
    blocks.emit('change', change)
    return change
  }

  blocks.set = (position, stateId, player = null) => {
    const change = blocks.put(position, stateId, player)
    if (change !== null) blocks.emit('update', change)
  }

  serv.blocks = blocks
  serv.setBlock = async (world, position, stateId) => { blocks.set(position, stateId) }
}
