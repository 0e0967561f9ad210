'use strict'

const { Vec3 } = require('vec3')

/** Directions of the protocol's face numbers: 0 down, 1 up, 2 north, 3 south, 4 west, 5 east. */
const FACES = [
  new Vec3(0, -1, 0), new Vec3(0, 1, 0), new Vec3(0, 0, -1),
  new Vec3(0, 0, 1), new Vec3(-1, 0, 0), new Vec3(1, 0, 0),
]
const FACE_NAMES = ['down', 'up', 'north', 'south', 'west', 'east']
const CLOCKWISE = { north: 'east', east: 'south', south: 'west', west: 'north' }
const OPPOSITE = {
  north: 'south', south: 'north', east: 'west', west: 'east', up: 'down', down: 'up',
}

const vectorOf = (name) => FACES[FACE_NAMES.indexOf(name)]
const clockwise = (name) => CLOCKWISE[name]
const opposite = (name) => OPPOSITE[name]
const counterclockwise = (name) => OPPOSITE[CLOCKWISE[name]]

/** Return the horizontal direction of a yaw in Minecraft's degrees (0 south, 90 west). */
function facingOfYaw (yaw) {
  return ['south', 'west', 'north', 'east'][((Math.floor(yaw / 90 + 0.5) % 4) + 4) % 4]
}

module.exports = {
  FACES, FACE_NAMES, vectorOf, clockwise, counterclockwise, opposite, facingOfYaw,
}
