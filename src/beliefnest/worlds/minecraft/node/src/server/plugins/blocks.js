'use strict'

const { EventEmitter } = require('events')
const { blockStates, encode } = require('./lib/states')

/**
 * Add `serv.blocks`: synchronous access to blocks. flying-squid's own accessors are asynchronous, so that two acts of
 * one tick could interleave; here an act is complete when the call returns.
 *
 * `serv.blocks.on('change', ({position, before, after, player}) => ...)` reports every change of a block state (ids)
 * from any source; `player` is set if a player caused it. The event `update` follows if adjacent blocks are to react:
 * a door's other half, unsupported sand.
 */
module.exports.server = (serv) => {
  const { registry } = serv
  const { describe, text } = blockStates(registry)
  const blocks = new EventEmitter()
  blocks.setMaxListeners(0)

  /** Return `{stateId, type, name, shapes, solid, full, transparent, properties}` of the block at a position. */
  blocks.at = (position) => describe(serv.overworld.sync.getBlockStateId(position))
  blocks.describe = describe
  blocks.text = text
  /** Return the state id of a name and properties. */
  blocks.state = (name, properties = {}) => encode(registry, name, properties)
  /** Return the state id of a block after a change of some properties. */
  blocks.stateWith = (block, properties) => encode(
    registry, block.name, { ...block.properties, ...properties })

  /** Send a player the block at a position, changed or not. */
  blocks.send = (player, position) => player._client.write('block_change', {
    location: position, type: serv.overworld.sync.getBlockStateId(position),
  })

  /** Set a block without any reaction of adjacent blocks. */
  blocks.put = (position, stateId, player = null) => {
    const before = serv.overworld.sync.getBlockStateId(position)
    if (before === stateId) return null
    serv.overworld.sync.setBlockStateId(position, stateId)
    for (const other of serv.players) {
      if (other.hasColumn?.(position)) blocks.send(other, position)
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
