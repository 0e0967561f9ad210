'use strict'
/**
 * Angles: Mineflayer's radians (yaw 0 along -z, counterclockwise; pitch up) and the
 * protocol's degrees (yaw 0 along +z, clockwise; pitch down) and 256 steps.
 */
const FULL_TURN = 2 * Math.PI
const DEGREES = 180 / Math.PI
// Clients send angles as 32-bit degrees, which are off by up to this much.
const SAME_ANGLE = 2e-6

/** @returns {number} the same angle, -pi < result <= pi */
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

/** @returns {number} degrees as a signed byte of 256 steps */
function angleStep (degrees) {
  return Math.floor(degrees * 256 / 360) << 24 >> 24
}

module.exports = { angleStep, fromDegrees, samePose, toDegrees, wrap }
