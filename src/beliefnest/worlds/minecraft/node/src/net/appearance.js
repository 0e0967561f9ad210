'use strict'
/**
 * Appearance of a player: the pose in which all bots of its region see it. The bots share one, so that a move costs the
 * same for any number of them. It changes when the packet of the move arrives, not when the player moves.
 */
const { Vec3 } = require('vec3')
const { fromNotchianPitchByte, fromNotchianYawByte } = require('mineflayer/lib/conversions')

/** Changes by each packet of a move, as Mineflayer makes them for the entities of one bot. */
const MOVES = {
  entity_teleport (appearance, { x, y, z, yaw, pitch }) {
    appearance.position.set(x, y, z)
    appearance.turn(yaw, pitch)
  },
  entity_look (appearance, { yaw, pitch }) { appearance.turn(yaw, pitch) },
  entity_head_rotation (appearance, { headYaw }) { appearance.headYaw = fromNotchianYawByte(headYaw) }
}

class Appearance {
  position = new Vec3(0, 0, 0)
  yaw = 0
  pitch = 0
  headYaw = undefined

  /** Take the pose from a packet `spawn_entity` or `entity_teleport`. */
  place (packet) {
    MOVES.entity_teleport(this, packet)
  }

  /** Take the change from a packet of a move. */
  move (name, packet) {
    MOVES[name](this, packet)
  }

  turn (yaw, pitch) {
    this.yaw = fromNotchianYawByte(yaw)
    this.pitch = fromNotchianPitchByte(pitch)
  }
}

module.exports = { Appearance }
