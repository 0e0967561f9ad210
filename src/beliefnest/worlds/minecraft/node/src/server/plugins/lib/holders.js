'use strict'

const { Vec3 } = require('vec3')
const { opposite, vectorOf } = require('./directions')

const ON_FLOOR = /^(torch|soul_torch|redstone_torch|redstone_wire|.*_carpet|.*_sapling|.*_tulip|.*_pressure_plate|rail|.*_rail|repeater|comparator|dandelion|poppy|cornflower|short_grass|fern|dead_bush|snow)$/
const ON_WALL = /^(ladder|wall_torch|soul_wall_torch|redstone_wall_torch|.*_wall_sign)$/
const ON_ANY = /^(lever|.*_button)$/
const DOWN = new Vec3(0, -1, 0)

/** Return the position of the block to which a block is attached; null if it needs none. */
function holderOf ({ name, properties }) {
  if (ON_FLOOR.test(name)) return DOWN
  if (ON_WALL.test(name)) return vectorOf(opposite(properties.facing))
  if (!ON_ANY.test(name)) return name.endsWith('_door') && properties.half === 'lower' ? DOWN : null
  if (properties.face === 'floor') return DOWN
  return properties.face === 'ceiling' ? vectorOf('up') : vectorOf(opposite(properties.facing))
}

module.exports = { holderOf }
