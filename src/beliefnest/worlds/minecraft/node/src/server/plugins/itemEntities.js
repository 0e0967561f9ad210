'use strict'

const { Vec3 } = require('vec3')
const { becomeItem, direction } = require('./lib/itemEntity')
const { centreOf } = require('./lib/positions')
const { toDegrees } = require('../angles')
const { toStep } = require('../../steps')

const MINED_DELAY = 10
const TOSSED_DELAY = 40
const TOSS_SPEED = 0.3
const TOSS_LIFT = 0.1
const POP_SPEED = 0.1
const BELOW_EYES = 0.3

/** Each tick has its own numbers, so that no number is used twice; the first ones are the players'. */
const NUMBERS_PER_TICK = 100

/**
 * Add dropped items. `serv.dropItem(position, item, {velocity, delay, id, thrown})` makes one that nobody can pick up
 * for `delay` ticks; `serv.itemEntities(within)` lists them (`{id, item, position}`); `serv.removeItem(id)` removes
 * one. itemMotion.js moves them.
 *
 * The number of an item is that of its entity. A new number depends on the tick and on the present entities, never on
 * earlier ones: a region that is created anew continues with the same numbers.
 */
module.exports.server = (serv) => {
  const stepped = ({ x, y, z }) => new Vec3(toStep(x), toStep(y), toStep(z))
  const type = serv.registry.entitiesByName.item.id

  /** Continue numbers from the present entities; called at the start of a call. */
  serv.numberItems = () => { serv.entityMaxId = Math.max(0, ...Object.keys(serv.entities).map(Number)) }

  const nextNumber = () => Math.max(serv.entityMaxId + 1, (serv.region.tick + 1) * NUMBERS_PER_TICK)

  serv.dropItem = (position, item, { velocity = new Vec3(0, 0, 0), delay = MINED_DELAY, id = nextNumber(), thrown = [] } = {}) => {
    serv.entityMaxId = id - 1
    const entity = serv.initEntity('object', type, serv.overworld, stepped(position))
    becomeItem(entity, serv.Item, { item, velocity, delay, born: serv.region.tick, thrown })
    entity.updateAndSpawn()
    return entity
  }
  serv.spawnObject = (_, world, position, { itemId, itemCount = 1, velocity }) =>
    serv.dropItem(position, new serv.Item(itemId, itemCount), { velocity })

  /** Drop an item out of a block that was broken or opened. */
  serv.popItem = (position, item) => serv.dropItem(
    centreOf(position), item, { velocity: new Vec3(0, POP_SPEED, 0) })

  /** Throw an item in the player's direction of view. */
  serv.tossItem = (player, item) => serv.dropItem(player.eyes().offset(0, -BELOW_EYES, 0), item, {
    velocity: direction(toDegrees(player.pose)).scaled(TOSS_SPEED).offset(0, TOSS_LIFT, 0),
    delay: TOSSED_DELAY,
    thrown: [[player.agent, item.count, serv.region.tick]],
  })

  serv.itemEntities = (within) => Object.values(serv.entities).filter(
    ({ item, position }) => item && within(position))

  serv.removeItem = (id) => serv.entities[id].destroy()

  /** Put an item at a position, at once. */
  serv.placeItem = (entity, position) => {
    if (position.equals(entity.position)) return
    entity.position = position
    const { x, y, z } = position
    serv._writeAll('entity_teleport', { entityId: entity.id, x, y, z, yaw: 0, pitch: 0, onGround: entity.onGround })
  }

  serv.keeps('items', {
    save: (region) => serv.itemEntities((place) => region.contains(place)).map(
      ({ id, velocity: { x, y, z }, delay, born, onGround, thrown }) => [id, x, y, z, delay, born, onGround, ...thrown]),
    restore (rows, region) {
      for (const entity of serv.itemEntities((place) => region.contains(place))) {
        Object.assign(entity, { velocity: new Vec3(0, 0, 0), delay: 0, born: region.tick, onGround: true, thrown: [] })
      }
      for (const [id, x, y, z, delay, born, onGround, ...thrown] of rows) {
        if (serv.entities[id]?.item) Object.assign(serv.entities[id], { velocity: new Vec3(x, y, z), delay, born, onGround, thrown })
      }
    },
  })
}
