'use strict'
/**
 * Conversion of angles between Mineflayer's radians (yaw 0 along -z, counterclockwise; pitch up), the protocol's
 * degrees (yaw 0 along +z, clockwise; pitch down) and its 256 steps.
 */
const FULL_TURN = 2 * Math.PI
const DEGREES = 180 / Math.PI
// Largest error, in radians, of an angle that a client sends as 32-bit degrees.
const SAME_ANGLE = 2e-6

/** Return the same angle in -pi < result <= pi. @returns {number} */
function wrap (angle) {
  const turned = (Math.PI - angle) % FULL_TURN
  return Math.PI - (turned < 0 ? turned + FULL_TURN : turned)
}

function fromDegrees (yaw, pitch) {
  return { yaw: wrap(Math.PI - yaw / DEGREES), pitch: wrap(-pitch / DEGREES) }
}

function toDegrees ({ yaw, pitch }) {
  return { yaw: (Math.PI - yaw) * DEGREES, pitch: -pitch * DEGREES }
}

function samePose (a, b) {
  return Math.abs(wrap(a.yaw - b.yaw)) < SAME_ANGLE && Math.abs(wrap(a.pitch - b.pitch)) < SAME_ANGLE
}

/** Return degrees as a signed byte of 256 steps. @returns {number} */
function angleStep (degrees) {
  return Math.floor(degrees * 256 / 360) << 24 >> 24
}

module.exports = { angleStep, fromDegrees, samePose, toDegrees, wrap }
