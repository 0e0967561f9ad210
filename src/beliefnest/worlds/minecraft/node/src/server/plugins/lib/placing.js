'use strict'

const { clockwise, counterclockwise, opposite, vectorOf } = require('./directions')

/**
 * States of placed blocks, by position and player.
 *
 * `spot` is `{face, cursor, facing, look, at(offset)}`: the clicked face (a name), the point on it, the player's view
 * direction (horizontal, and in six directions), and the block at an offset from the position.
 */

const BLOCK_OF_ITEM = { redstone: 'redstone_wire', string: 'tripwire' }
const ON_WALLS = {
  torch: 'wall_torch', soul_torch: 'soul_wall_torch', redstone_torch: 'redstone_wall_torch',
}
const SIX_WAYS = /^(barrel|dispenser|dropper|piston|sticky_piston|observer|command_block)$/
const ALONG_LOOK = /(_stairs|_door|_fence_gate|_bed)$/
const ON_FACE = /^ladder$|_wall_sign$|wall_torch$/

const axisOf = (face) => ({ up: 'y', down: 'y', north: 'z', south: 'z', east: 'x', west: 'x' })[face]
const isSide = (face) => face !== 'up' && face !== 'down'

function halfOf ({ face, cursor }) {
  if (face === 'up') return 'bottom'
  if (face === 'down') return 'top'
  return cursor.y > 0.5 ? 'top' : 'bottom'
}

function attached ({ face, facing }) {
  if (face === 'up') return { face: 'floor', facing }
  if (face === 'down') return { face: 'ceiling', facing }
  return { face: 'wall', facing: face }
}

/** Return the type of a chest: it joins an adjacent single chest with the same facing. */
function chestType (name, facing, spot) {
  const joins = (side) => {
    const { name: other, properties } = spot.at(vectorOf(side))
    return other === name && properties.type === 'single' && properties.facing === facing
  }
  if (spot.sneaking) return 'single'
  if (joins(clockwise(facing))) return 'left'
  return joins(counterclockwise(facing)) ? 'right' : 'single'
}

function facingFor (name, spot) {
  if (ON_FACE.test(name)) return spot.face
  if (SIX_WAYS.test(name)) return name === 'observer' ? spot.look : opposite(spot.look)
  if (ALONG_LOOK.test(name)) return spot.facing
  if (name.endsWith('_trapdoor') && isSide(spot.face)) return spot.face
  return opposite(spot.facing)
}

/** Return the name of the block that an item becomes there; undefined if it becomes none. */
function blockFor (registry, item, spot) {
  const name = BLOCK_OF_ITEM[item.name] ?? item.name
  if (isSide(spot.face) && ON_WALLS[name]) return ON_WALLS[name]
  if (isSide(spot.face) && name.endsWith('_sign')) return name.replace(/_sign$/, '_wall_sign')
  return registry.blocksByName[name] ? name : undefined
}

const RULES = {
  axis: (name, spot) => ({ axis: axisOf(spot.face) }),
  half: (name, spot) => ({ half: /_door$|_plant$/.test(name) ? 'lower' : halfOf(spot) }),
  facing: (name, spot) => ({ facing: facingFor(name, spot) }),
  face: (name, spot) => attached(spot),
  rotation: (name, spot) => ({ rotation: (Math.floor((spot.yaw + 180) * 16 / 360 + 0.5)) & 15 }),
  waterlogged: (name, spot) => ({ waterlogged: spot.at(vectorOf('up').scaled(0)).name === 'water' }),
}

/** Return the properties of the placed block that differ from its default ones. @returns {object} */
function propertiesFor (registry, name, spot) {
  const own = registry.blocksByName[name].states.map((state) => state.name)
  const properties = Object.assign({}, ...own
    .sort((a, b) => (a === 'face') - (b === 'face'))
    .map((property) => RULES[property]?.(name, spot)))
  if (name.endsWith('_slab')) properties.type = halfOf(spot)
  if (/^(trapped_)?chest$/.test(name)) properties.type = chestType(name, properties.facing, spot)
  return properties
}

module.exports = { blockFor, propertiesFor }
