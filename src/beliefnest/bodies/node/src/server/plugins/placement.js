'use strict'

const { Vec3 } = require('vec3')
const { FACES, FACE_NAMES, facingOfYaw, vectorOf, clockwise, counterclockwise } = require('./lib/directions')
const { blockFor, propertiesFor, halfOf } = require('./lib/placing')
const { withCount } = require('./lib/items')
const { listOf } = require('./lib/positions')
const { toDegrees } = require('../angles')

const REPLACEABLE = new Set([
  'air', 'cave_air', 'void_air', 'water', 'lava', 'short_grass', 'tall_grass', 'fern', 'large_fern',
  'dead_bush', 'vine', 'snow', 'fire', 'soul_fire', 'seagrass', 'tall_seagrass', 'light',
])
const STEEP = 45
const HALF_WIDTH = 0.3
const HEIGHT = 1.8

/** Putting blocks: in the state the game gives them, not into anybody, one item each. */
module.exports.server = (serv) => {
  const isFree = (position) => REPLACEABLE.has(serv.blocks.at(position).name)

  function spotOf ({ player, face, cursor }, position) {
    const { yaw, pitch } = toDegrees(player.pose)
    const facing = facingOfYaw(yaw)
    const look = Math.abs(pitch) > STEEP ? (pitch > 0 ? 'down' : 'up') : facing
    return {
      face: FACE_NAMES[face],
      cursor,
      yaw,
      facing,
      look,
      sneaking: player.crouching,
      at: (offset) => serv.blocks.at(position.plus(offset)),
    }
  }

  /** Whether a block's shapes would lie in somebody's body. */
  function hitsSomebody (position, stateId) {
    return serv.blocks.describe(stateId).shapes.some((s) => serv.players.some(({ position: at }) =>
      at.x - HALF_WIDTH < position.x + s[3] && at.x + HALF_WIDTH > position.x + s[0] &&
      at.y < position.y + s[4] && at.y + HEIGHT > position.y + s[1] &&
      at.z - HALF_WIDTH < position.z + s[5] && at.z + HALF_WIDTH > position.z + s[2]))
  }

  /** The second block of doors and beds: `[offset, properties]`. */
  function secondPart (name, properties) {
    if (name.endsWith('_door')) return [new Vec3(0, 1, 0), { ...properties, half: 'upper' }]
    if (name.endsWith('_bed')) return [vectorOf(properties.facing), { ...properties, part: 'head' }]
    return null
  }

  /** Two halves of one kind make a whole block. */
  function joinSlabs ({ position, block, face }, item, spot) {
    const { type } = block.properties
    if (block.name !== item.name || !item.name.endsWith('_slab') || type === 'double') return null
    const onto = (type === 'bottom' && FACE_NAMES[face] === 'up') || (type === 'top' && FACE_NAMES[face] === 'down')
    if (!onto && halfOf(spot) === type) return null
    return onto ? { position, states: [[position, serv.blocks.state(item.name, { type: 'double' })]] } : null
  }

  function plan (use, item) {
    const inPlace = isFree(use.position)
    const position = inPlace ? use.position : use.position.plus(FACES[use.face])
    const spot = spotOf(use, position)
    const joined = joinSlabs(use, item, spot)
    if (joined) return joined
    const name = blockFor(serv.registry, item, spot)
    if (!name || !isFree(position)) return null
    const properties = propertiesFor(serv.registry, name, spot)
    const states = [[position, serv.blocks.state(name, properties)]]
    const second = secondPart(name, properties)
    if (second) {
      const other = position.plus(second[0])
      if (!isFree(other)) return null
      states.push([other, serv.blocks.state(name, second[1])])
    }
    return { position, states }
  }

  /** The neighbour a new half of a double chest joins becomes the other half. */
  function joinChests (position, player) {
    const { name, properties } = serv.blocks.at(position)
    if (!/^(trapped_)?chest$/.test(name) || properties.type === 'single') return
    const turn = properties.type === 'left' ? clockwise : counterclockwise
    const other = position.plus(vectorOf(turn(properties.facing)))
    const type = properties.type === 'left' ? 'right' : 'left'
    serv.blocks.set(other, serv.blocks.stateWith(serv.blocks.at(other), { type }), player)
  }

  /** What the item in hand does to the block it is used on; returns whether it did something. */
  serv.useItemOn = (use) => {
    const { player, hand } = use
    const item = player.itemInHand(hand)
    const planned = item && plan(use, item)
    if (!planned || planned.states.some(([position, state]) => hitsSomebody(position, state))) return false
    planned.states.forEach(([position, state]) => serv.blocks.set(position, state, player))
    joinChests(planned.position, player)
    player.inventory.slots[player.slotOfHand(hand)] = withCount(item, item.count - 1)
    player.inventoryChanged()
    player.emitEvent({
      kind: 'place_block',
      detail: { position: listOf(planned.position), block: serv.blocks.text(planned.states[0][1]) },
    })
    return true
  }
}

