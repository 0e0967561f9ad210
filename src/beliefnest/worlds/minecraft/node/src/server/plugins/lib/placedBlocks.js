'use strict'

const { Vec3 } = require('vec3')
const { FACES, FACE_NAMES, facingOfYaw, vectorOf } = require('./directions')
const { blockFor, propertiesFor } = require('./placing')
const { toDegrees } = require('../../angles')

const REPLACEABLE = new Set([
  'air', 'cave_air', 'void_air', 'water', 'lava', 'short_grass', 'tall_grass', 'fern', 'large_fern',
  'dead_bush', 'vine', 'snow', 'fire', 'soul_fire', 'seagrass', 'tall_seagrass', 'light',
])
const STEEP = 45
const HALF_WIDTH = 0.3
const HEIGHT = 1.8

/** Return the spot of a placement (see placing.js). */
function spotOf (blocks, { player, face, cursor }, position) {
  const { yaw, pitch } = toDegrees(player.pose)
  const facing = facingOfYaw(yaw)
  const steep = pitch > 0 ? 'down' : 'up'
  return {
    face: FACE_NAMES[face],
    cursor,
    yaw,
    facing,
    look: Math.abs(pitch) > STEEP ? steep : facing,
    sneaking: player.crouching,
    at: (offset) => blocks.at(position.plus(offset)),
  }
}

/** Return the second block of doors and beds as `[offset, properties]`; null for other blocks. */
function secondPart (name, properties) {
  if (name.endsWith('_door')) return [new Vec3(0, 1, 0), { ...properties, half: 'upper' }]
  if (name.endsWith('_bed')) return [vectorOf(properties.facing), { ...properties, part: 'head' }]
  return null
}

/** Return true if the item is the other half of the clicked slab. */
function completesSlab ({ block, face }, item) {
  if (block.name !== item.name || !item.name.endsWith('_slab')) return false
  const { type } = block.properties
  return (type === 'bottom' && FACE_NAMES[face] === 'up') || (type === 'top' && FACE_NAMES[face] === 'down')
}

/**
 * Return the blocks that placing an item would set.
 * @param {object} blocks `serv.blocks`
 * @param {object} use use of a block, as handlers of `serv.onInteraction` get it
 * @returns {{position: Vec3, states: [Vec3, number][]} | null} null if nothing can be placed
 */
function planPlacement (registry, blocks, use, item) {
  if (completesSlab(use, item)) {
    return { position: use.position, states: [[use.position, blocks.state(item.name, { type: 'double' })]] }
  }
  const isFree = (place) => REPLACEABLE.has(blocks.at(place).name)
  const position = isFree(use.position) ? use.position : use.position.plus(FACES[use.face])
  const spot = spotOf(blocks, use, position)
  const name = blockFor(registry, item, spot)
  if (!name || !isFree(position)) return null
  const properties = propertiesFor(registry, name, spot)
  const states = [[position, blocks.state(name, properties)]]
  const second = secondPart(name, properties)
  if (second) states.push([position.plus(second[0]), blocks.state(name, second[1])])
  return states.every(([place]) => isFree(place)) ? { position, states } : null
}

/** Return true if a block's shapes would overlap the body of one of `players`. */
function hitsSomebody (players, shapes, position) {
  return shapes.some((s) => players.some(({ position: at }) =>
    at.x - HALF_WIDTH < position.x + s[3] && at.x + HALF_WIDTH > position.x + s[0] &&
    at.y < position.y + s[4] && at.y + HEIGHT > position.y + s[1] &&
    at.z - HALF_WIDTH < position.z + s[5] && at.z + HALF_WIDTH > position.z + s[2]))
}

module.exports = { planPlacement, hitsSomebody }
