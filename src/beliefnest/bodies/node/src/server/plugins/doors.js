'use strict'

const { facingOfYaw, opposite } = require('./lib/directions')
const { toDegrees } = require('../angles')

const BY_HAND = /^(?!iron_).*(_door|_trapdoor|_fence_gate)$/

/** Doors, trapdoors and fence gates open and shut by hand; iron ones do not. */
module.exports.server = (serv) => {
  function otherHalf (position, block) {
    return position.offset(0, block.properties.half === 'lower' ? 1 : -1, 0)
  }

  function toggleDoor ({ player, position, block }) {
    const open = !block.properties.open
    serv.blocks.set(position, serv.blocks.stateWith(block, { open }), player)
    const other = otherHalf(position, block)
    const half = serv.blocks.at(other)
    if (half.name === block.name) serv.blocks.set(other, serv.blocks.stateWith(half, { open }), player)
    return true
  }

  function toggleTrapdoor ({ player, position, block }) {
    const open = !block.properties.open
    serv.blocks.set(position, serv.blocks.stateWith(block, { open }), player)
    return true
  }

  /** A gate opens away from who opens it. */
  function toggleGate ({ player, position, block }) {
    const open = !block.properties.open
    const { facing } = block.properties
    const away = facingOfYaw(toDegrees(player.pose).yaw)
    const turned = open && away === opposite(facing) ? away : facing
    serv.blocks.set(position, serv.blocks.stateWith(block, { open, facing: turned }), player)
    return true
  }

  for (const { name } of serv.registry.blocksArray) {
    if (!BY_HAND.test(name)) continue
    if (name.endsWith('_trapdoor')) serv.onInteraction(name, toggleTrapdoor)
    else if (name.endsWith('_fence_gate')) serv.onInteraction(name, toggleGate)
    else serv.onInteraction(name, toggleDoor)
  }

  /** A door is two blocks; without one the other does not stand. */
  serv.blocks.on('update', ({ position, before, after, player }) => {
    const old = serv.blocks.describe(before)
    if (!old.name.endsWith('_door') || serv.blocks.describe(after).name === old.name) return
    const other = otherHalf(position, old)
    if (serv.blocks.at(other).name === old.name) serv.blocks.set(other, 0, player)
  })
}
