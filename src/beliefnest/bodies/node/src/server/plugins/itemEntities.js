'use strict'

const { Vec3 } = require('vec3')
const { becomeItem, direction } = require('./lib/itemEntity')
const { centreOf } = require('./lib/positions')
const { toDegrees } = require('../angles')

const MINED_DELAY = 10
const TOSSED_DELAY = 40
const TOSS_SPEED = 0.3
const TOSS_LIFT = 0.1
const POP_SPEED = 0.1
const BELOW_EYES = 0.3

/**
 * Making dropped items: `serv.dropItem(position, item, {velocity, delay})` makes one, which
 * nobody can pick up for `delay` ticks; `serv.itemEntities(within)` lists them (`{id, item, position}`).
 * What becomes of them is in itemMotion.js.
 */
module.exports.server = (serv) => {
  const type = serv.registry.entitiesByName.item.id

  serv.dropItem = (position, item, { velocity = new Vec3(0, 0, 0), delay = MINED_DELAY } = {}) => {
    const entity = serv.initEntity('object', type, serv.overworld, position.clone())
    becomeItem(entity, serv.Item, { item, velocity, delay })
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
}
