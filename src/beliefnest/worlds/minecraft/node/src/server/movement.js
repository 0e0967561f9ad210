'use strict'
/**
 * Positions and views of players. flying-squid rounds angles to 256 steps and sends positions as rounded differences;
 * this module keeps both exactly as the player's client sent them.
 */
const { Vec3 } = require('vec3')
const { Appearance } = require('../net/appearance')
const { angleStep, fromDegrees, samePose, toDegrees } = require('./angles')

module.exports.name = 'updatePositions'

module.exports.player = player => {
  player.pose = { yaw: 0, pitch: 0 }
  player.appearance = new Appearance()
  // Block from which the current walk began.
  player.stoodAt = player.position.floored()
  // In Minecraft's degrees, which plugins use for throwing and placing.
  Object.defineProperty(player, 'look', { get: () => toDegrees(player.pose) })

  player._client.on('position', ({ x, y, z, onGround }) => {
    moveTo(player, x, y, z)
    player.onGround = onGround
  })
  player._client.on('look', ({ yaw, pitch, onGround }) => {
    turnTo(player, yaw, pitch)
    player.onGround = onGround
  })
  player._client.on('position_look', ({ x, y, z, yaw, pitch, onGround }) => {
    turnTo(player, yaw, pitch)
    moveTo(player, x, y, z)
    player.onGround = onGround
  })
  player._client.on('flying', ({ onGround }) => { player.onGround = onGround })

  /** Put the player at a position, at once and exactly; a missing angle stays unchanged. */
  player.place = (position, yaw = player.pose.yaw, pitch = player.pose.pitch) => {
    player.pose = { yaw, pitch }
    showTurn(player)
    moveTo(player, position.x, position.y, position.z)
    player.stoodAt = player.position.floored()
    player.sendSelfPosition()
  }
  player.teleport = async position => { player.place(position) }

  player.sendSelfPosition = () => {
    const { x, y, z } = player.position
    const { yaw, pitch } = toDegrees(player.pose)
    player._client.write('position', { x, y, z, yaw, pitch, flags: 0, teleportId: 1 })
  }
}

module.exports.entity = entity => {
  /** Move an entity and show the move to all who see it. */
  entity.sendPosition = async (position, onGround) => {
    entity.onGround = onGround
    if (!entity.position.equals(position)) moveTo(entity, position.x, position.y, position.z)
  }
}

function moveTo (entity, x, y, z) {
  const { position } = entity
  if (position.x === x && position.y === y && position.z === z) return
  entity.position = new Vec3(x, y, z)
  entity.showMove('entity_teleport', {
    entityId: entity.id, x, y, z, yaw: entity.yaw, pitch: entity.pitch, onGround: entity.onGround
  })
}

function turnTo (player, yawDegrees, pitchDegrees) {
  const pose = fromDegrees(yawDegrees, pitchDegrees)
  if (samePose(pose, player.pose)) return
  player.pose = pose
  showTurn(player)
}

function showTurn (player) {
  const { yaw, pitch } = toDegrees(player.pose)
  player.yaw = angleStep(yaw)
  player.pitch = angleStep(pitch)
  player.showMove('entity_look', {
    entityId: player.id, yaw: player.yaw, pitch: player.pitch, onGround: player.onGround
  })
  player.showMove('entity_head_rotation', { entityId: player.id, headYaw: player.yaw })
}
