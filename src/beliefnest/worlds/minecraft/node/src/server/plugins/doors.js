'use strict'

const { facingOfYaw, opposite } = require('./lib/directions')
const { listOf } = require('./lib/positions')
const { toDegrees } = require('../angles')

const BY_HAND = /^(?!iron_).*(_door|_trapdoor|_fence_gate)$/

/**
 * Add doors, trapdoors and fence gates, which open and shut by hand unless they are of iron. The position of a door is
 * that of its lower half.
 */
module.exports.server = (serv) => {
  function otherHalf (position, block) {
    return position.offset(0, block.properties.half === 'lower' ? 1 : -1, 0)
  }

  function used (player, position, open) {
    player.emitEvent({ kind: 'use_door', detail: { position: listOf(position), open } })
    return true
  }

  function toggleDoor ({ player, position, block }) {
    const open = !block.properties.open
    serv.blocks.set(position, serv.blocks.stateWith(block, { open }), player)
    const other = otherHalf(position, block)
    const half = serv.blocks.at(other)
    if (half.name === block.name) serv.blocks.set(other, serv.blocks.stateWith(half, { open }), player)
    return used(player, block.properties.half === 'lower' ? position : other, open)
  }

  function toggleTrapdoor ({ player, position, block }) {
    const open = !block.properties.open
    serv.blocks.set(position, serv.blocks.stateWith(block, { open }), player)
    return used(player, position, open)
  }

  /** Open a gate away from the player, or shut it. */
  function toggleGate ({ player, position, block }) {
    const open = !block.properties.open
    const { facing } = block.properties
    const away = facingOfYaw(toDegrees(player.pose).yaw)
    const turned = open && away === opposite(facing) ? away : facing
    serv.blocks.set(position, serv.blocks.stateWith(block, { open, facing: turned }), player)
    return used(player, position, open)
  }

  for (const { name } of serv.registry.blocksArray) {
    if (!BY_HAND.test(name)) continue
    if (name.endsWith('_trapdoor')) serv.onInteraction(name, toggleTrapdoor)
    else if (name.endsWith('_fence_gate')) serv.onInteraction(name, toggleGate)
    else serv.onInteraction(name, toggleDoor)
  }

  /** Remove the other half of a door when one half is gone. */
  serv.blocks.on('update', ({ position, before, after, player }) => {
    const old = serv.blocks.describe(before)
    if (!old.name.endsWith('_door') || serv.blocks.describe(after).name === old.name) return
    const other = otherHalf(position, old)
    if (serv.blocks.at(other).name === old.name) serv.blocks.set(other, 0, player)
  })
}
