'use strict'

const { EventEmitter } = require('events')
const { decode, encode } = require('./lib/states')

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
  const Block = require('prismarine-block')(registry)
  const known = new Map()
  const blocks = new EventEmitter()
  blocks.setMaxListeners(0)

  function describe (stateId) {
    if (!known.has(stateId)) {
      const block = Block.fromStateId(stateId, 0)
      known.set(stateId, Object.freeze({
        stateId,
        type: block.type,
        name: block.name,
        shapes: block.shapes,
        solid: block.boundingBox === 'block',
        transparent: block.transparent,
        properties: Object.freeze(decode(registry, stateId)),
      }))
    }
    return known.get(stateId)
  }

  /** `{stateId, type, name, shapes, solid, transparent, properties}` of the block there. */
  blocks.at = (position) => describe(serv.overworld.sync.getBlockStateId(position))
  blocks.describe = describe
  /** State id by name and properties. */
  blocks.state = (name, properties = {}) => encode(registry, name, properties)
  /** The state a block has after some of its properties changed. */
  blocks.stateWith = (block, properties) => encode(
    registry, block.name, { ...block.properties, ...properties })

  /** A state as text, e.g. `lever[face=floor,facing=north,powered=true]`. */
  blocks.text = (stateId) => {
    const { name, properties } = describe(stateId)
    const entries = Object.entries(properties).sort(([a], [b]) => (a < b ? -1 : 1))
    return entries.length ? `${name}[${entries.map((entry) => entry.join('=')).join(',')}]` : name
  }

  /** Tells a player what is there, whether or not it changed. */
  blocks.send = (player, position) => player._client.write('block_change', {
    location: position, type: serv.overworld.sync.getBlockStateId(position),
  })

  /** Sets a block as it is, and nothing else: what is beside it does not take notice. */
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
