'use strict'
/**
 * Block objects, quickly. Worlds are asked for blocks thousands of times a tick, and
 * `new Block` works out every property anew; here a block is worked out once per state and
 * handed out again as long as its place keeps that state.
 */

/** Makes `getBlock` of a version's chunk columns remember what it made. */
function rememberBlocks (registry) {
  const Block = require('prismarine-block')(registry)
  const Chunk = require('prismarine-chunk')(registry)
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

  Chunk.prototype.getBlock = function getBlock (position) {
    const stateId = this.getBlockStateId(position)
    this.remembered ??= new Map()
    const key = ((position.y - this.minY) << 8) | (position.z << 4) | position.x
    let block = this.remembered.get(key)
    // An object that was handed out is never changed: it stays what was seen then.
    if (block === undefined || block.stateId !== stateId) {
      block = make(stateId)
      this.remembered.set(key, block)
    }
    if (hasAny(this.blockEntities)) block.entity = this.getBlockEntity(position)
    return block
  }
}

function hasAny (entries) {
  for (const key in entries) return key !== undefined
  return false
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
