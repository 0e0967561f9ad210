'use strict'

const { Vec3 } = require('vec3')

const METADATA_ITEM = 8
const PICKUP = { side: 1.425, below: 0.75, above: 2.3 }

/** Return the direction of a view in degrees, as a vector of length 1. */
function direction ({ yaw, pitch }) {
  const [y, p] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180)
  return new Vec3(-Math.sin(y) * Math.cos(p), -Math.sin(p), Math.cos(y) * Math.cos(p))
}

/** Return true if an item at a point is near enough to be picked up by a player at `at`. */
function isInReach (at, { x, y, z }) {
  return Math.abs(at.x - x) <= PICKUP.side && Math.abs(at.z - z) <= PICKUP.side &&
    y >= at.y - PICKUP.below && y <= at.y + PICKUP.above
}

/** Return the metadata that show a client which item lies there. */
const metadataOf = (Item, { id, item }) => ({
  entityId: id,
  metadata: [{ key: METADATA_ITEM, type: 'item_stack', value: Item.toNotch(item) }],
})

/**
 * Turn an entity of the server into a dropped item; `thrown` as in throws.js; `itemId` and `itemCount` are those of
 * `item`.
 */
function becomeItem (entity, Item, { item, velocity, delay, born, thrown }) {
  Object.assign(entity, {
    uuid: `00000000-0000-4000-8000-${entity.id.toString(16).padStart(12, '0')}`,
    name: 'item',
    item,
    velocity,
    delay,
    born,
    thrown,
    onGround: false,
    showMetadata: (player) => player._client.write('entity_metadata', metadataOf(Item, entity)),
  })
  Object.defineProperties(entity, {
    itemId: { get: () => entity.item.type },
    itemCount: { get: () => entity.item.count },
  })
}

module.exports = { becomeItem, direction, isInReach, metadataOf }
