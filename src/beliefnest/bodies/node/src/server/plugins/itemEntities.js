'use strict'

const { Vec3 } = require('vec3')
const { alike, withCount } = require('./lib/items')
const { step } = require('./lib/motion')
const { centreOf } = require('./lib/positions')
const { toDegrees } = require('../angles')

const MINED_DELAY = 10
const TOSSED_DELAY = 40
const LIFETIME = 6000
const TOSS_SPEED = 0.3
const TOSS_LIFT = 0.1
const POP_SPEED = 0.1
const BELOW_EYES = 0.3
const METADATA_ITEM = 8
const PICKUP = { side: 1.425, below: 0.75, above: 2.3 }
const VOID_DEPTH = 64

/** A look in degrees as a direction of length 1. */
function direction ({ yaw, pitch }) {
  const [y, p] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180)
  return new Vec3(-Math.sin(y) * Math.cos(p), -Math.sin(p), Math.cos(y) * Math.cos(p))
}

function inReach (player, { x, y, z }) {
  const { position: at } = player
  return Math.abs(at.x - x) <= PICKUP.side && Math.abs(at.z - z) <= PICKUP.side &&
    y >= at.y - PICKUP.below && y <= at.y + PICKUP.above
}

/**
 * Dropped items: they fall, lie, are picked up as far as they fit, and vanish after 6000 ticks.
 * `serv.dropItem(position, item, {velocity, delay})` makes one, `serv.itemEntities(within)`
 * lists them (`{id, item, position}`); their entity ids are those players see.
 */
module.exports.server = (serv) => {
  const type = serv.registry.entitiesByName.item.id
  const shapesAt = (position) => serv.blocks.at(position).shapes

  const metadata = (entity) => ({
    entityId: entity.id,
    metadata: [{ key: METADATA_ITEM, type: 'item_stack', value: serv.Item.toNotch(entity.item) }],
  })

  const remove = (entity) => entity.destroy()
  const exists = (entity) => serv.entities[entity.id] === entity

  serv.dropItem = (position, item, { velocity = new Vec3(0, 0, 0), delay = MINED_DELAY } = {}) => {
    const entity = serv.initEntity('object', type, serv.overworld, position.clone())
    Object.assign(entity, {
      uuid: `00000000-0000-4000-8000-${entity.id.toString(16).padStart(12, '0')}`,
      name: 'item',
      item,
      delay,
      age: 0,
      velocity,
      onGround: false,
    })
    entity.showMetadata = (player) => player._client.write('entity_metadata', metadata(entity))
    Object.defineProperties(entity, {
      itemId: { get: () => entity.item.type },
      itemCount: { get: () => entity.item.count },
    })
    entity.updateAndSpawn()
    return entity
  }
  serv.spawnObject = (_, world, position, { itemId, itemCount = 1, velocity }) =>
    serv.dropItem(position, new serv.Item(itemId, itemCount), { velocity })

  /** Out of a block that was broken or opened. */
  serv.popItem = (position, item) => serv.dropItem(
    centreOf(position), item, { velocity: new Vec3(0, POP_SPEED, 0) })

  /** Thrown by a player where it looks. */
  serv.tossItem = (player, item) => serv.dropItem(player.eyes().offset(0, -BELOW_EYES, 0), item, {
    velocity: direction(toDegrees(player.pose)).scaled(TOSS_SPEED).offset(0, TOSS_LIFT, 0),
    delay: TOSSED_DELAY,
  })

  serv.itemEntities = (within) => Object.values(serv.entities).filter(
    ({ item, position }) => item && within(position))
  serv.removeItemEntities = (within) => serv.itemEntities(within).forEach(remove)

  function collect (player, entity) {
    const rest = player.storeItem(entity.item)
    const taken = entity.item.count - (rest?.count ?? 0)
    if (taken === 0) return
    serv._writeAll('collect', {
      collectedEntityId: entity.id, collectorEntityId: player.id, pickupItemCount: taken,
    })
    if (rest) {
      entity.item = rest
      serv._writeAll('entity_metadata', metadata(entity))
    } else {
      remove(entity)
    }
  }

  /** Alike items that lie together become one stack, as far as a stack goes. */
  function merge (entity) {
    for (const other of serv.itemEntities(() => true)) {
      if (other === entity || !alike(other.item, entity.item)) continue
      if (other.position.distanceTo(entity.position) > 0.5) continue
      const count = other.item.count + entity.item.count
      if (count > entity.item.stackSize) continue
      entity.item = withCount(entity.item, count)
      entity.delay = Math.max(entity.delay, other.delay)
      remove(other)
      serv._writeAll('entity_metadata', metadata(entity))
    }
  }

  function fall (entity) {
    const before = entity.position
    const next = step(entity, shapesAt)
    const landed = next.onGround && !entity.onGround
    Object.assign(entity, next)
    if (landed) merge(entity)
    if (before.equals(entity.position)) return
    const { x, y, z } = entity.position
    serv._writeAll('entity_teleport', {
      entityId: entity.id, x, y, z, yaw: 0, pitch: 0, onGround: next.onGround,
    })
  }

  function tick (entity) {
    entity.age += 1
    if (entity.delay > 0) entity.delay -= 1
    fall(entity)
    const lost = entity.position.y < serv.minY - VOID_DEPTH
    if (entity.age >= LIFETIME || lost) remove(entity)
    if (entity.delay > 0) return
    for (const player of serv.players) {
      if (!exists(entity)) return
      if (player.health > 0 && inReach(player, entity.position)) collect(player, entity)
    }
  }

  serv.onTick((within) => {
    for (const entity of serv.itemEntities(within)) {
      if (exists(entity)) tick(entity)
    }
  })
}
