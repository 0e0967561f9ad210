'use strict'

const { handOver } = require('./lib/gifts')
const { alike, withCount } = require('./lib/items')
const { isInReach, metadataOf } = require('./lib/itemEntity')
const { step } = require('./lib/motion')
const { together, without } = require('./lib/throws')

const LIFETIME = 6000
const MERGE_DISTANCE = 0.5
const VOID_DEPTH = 64

/** Move dropped items: they fall, lie, merge, are picked up as far as they fit, and finally vanish. */
module.exports.server = (serv) => {
  const shapesAt = (position) => serv.blocks.at(position).shapes
  const exists = (entity) => serv.entities[entity.id] === entity
  const showItem = (entity) => serv._writeAll('entity_metadata', metadataOf(serv.Item, entity))

  function collect (player, entity) {
    const rest = player.storeItem(entity.item)
    const taken = entity.item.count - (rest?.count ?? 0)
    if (taken === 0) return
    const { by, left } = without(entity.thrown, taken)
    entity.thrown = left
    handOver(serv.players, serv.region.tick, player, by, withCount(entity.item, taken))
    serv._writeAll('collect', {
      collectedEntityId: entity.id, collectorEntityId: player.id, pickupItemCount: taken,
    })
    if (rest) {
      entity.item = rest
      showItem(entity)
    } else {
      entity.destroy()
    }
  }

  /** Merge equal items that lie together, up to a full stack. */
  function merge (entity) {
    for (const other of serv.itemEntities(() => true)) {
      if (other === entity || !alike(other.item, entity.item)) continue
      if (other.position.distanceTo(entity.position) > MERGE_DISTANCE) continue
      const count = other.item.count + entity.item.count
      if (count > entity.item.stackSize) continue
      entity.item = withCount(entity.item, count)
      entity.thrown = together(entity.thrown, other.thrown)
      entity.delay = Math.max(entity.delay, other.delay)
      other.destroy()
      showItem(entity)
    }
  }

  function fall (entity) {
    const { position, velocity, onGround } = step(entity, shapesAt)
    const landed = onGround && !entity.onGround
    Object.assign(entity, { velocity, onGround })
    serv.placeItem(entity, position)
    if (landed) merge(entity)
  }

  function tick (entity) {
    if (entity.delay > 0) entity.delay -= 1
    fall(entity)
    if (serv.region.tick - entity.born >= LIFETIME || entity.position.y < serv.minY - VOID_DEPTH) entity.destroy()
    if (entity.delay > 0) return
    for (const player of serv.players) {
      if (!exists(entity)) return
      if (player.health > 0 && isInReach(player.position, entity.position)) collect(player, entity)
    }
  }

  serv.onTick((within) => {
    for (const entity of serv.itemEntities(within)) {
      if (exists(entity)) tick(entity)
    }
  })
}
