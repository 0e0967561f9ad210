'use strict'

const { Vec3 } = require('vec3')
const { toStep } = require('../../../steps')

/** Motion of a small box through blocks, per tick, as the game moves dropped items. */

const GRAVITY = 0.04
const DRAG = 0.98
const GROUND_DRAG = 0.588
const HALF = 0.125
const HEIGHT = 0.25
const REST = 1e-3

function boxAt ({ x, y, z }) {
  return [x - HALF, y, z - HALF, x + HALF, y + HEIGHT, z + HALF]
}

const overlaps = (a, b) => a[0] < b[3] && a[3] > b[0] && a[1] < b[4] && a[4] > b[1] &&
  a[2] < b[5] && a[5] > b[2]

/** Return the collision boxes around `box`, in world coordinates; `shapesAt(position)` returns those of one block. */
function obstacles (box, shapesAt) {
  const boxes = []
  for (let x = Math.floor(box[0]); x <= Math.floor(box[3]); x++) {
    // Begin one block lower: fences and walls are higher than their block.
    for (let y = Math.floor(box[1]) - 1; y <= Math.floor(box[4]); y++) {
      for (let z = Math.floor(box[2]); z <= Math.floor(box[5]); z++) {
        for (const s of shapesAt(new Vec3(x, y, z))) {
          boxes.push([s[0] + x, s[1] + y, s[2] + z, s[3] + x, s[4] + y, s[5] + z])
        }
      }
    }
  }
  return boxes
}

/** Return how far a box can move along one axis (0 x, 1 y, 2 z). */
function free (box, axis, distance, blocks) {
  const swept = [...box]
  if (distance < 0) swept[axis] += distance
  else swept[axis + 3] += distance
  let reach = distance
  for (const block of blocks) {
    if (!overlaps(swept, block) || overlaps(box, block)) continue
    const gap = distance < 0 ? block[axis + 3] - box[axis] : block[axis] - box[axis + 3]
    if (Math.abs(gap) < Math.abs(reach)) reach = gap
  }
  return reach
}

/**
 * Advance `{position, velocity}` by one tick. Return the next position and velocity, and whether the box stands on
 * something.
 */
function step ({ position, velocity }, shapesAt) {
  const { x: east, y: up, z: south } = velocity
  const speed = new Vec3(toStep(east), toStep(up - GRAVITY), toStep(south))
  const next = position.clone()
  const moved = new Vec3(0, 0, 0)
  for (const [axis, name] of [[1, 'y'], [0, 'x'], [2, 'z']]) {
    const box = boxAt(next)
    const swept = box.map((edge, i) => edge + (i < 3 ? -1 : 1) * (Math.abs(speed[name]) + REST))
    moved[name] = free(box, axis, speed[name], obstacles(swept, shapesAt))
    next[name] += moved[name]
  }
  const onGround = speed.y < 0 && moved.y !== speed.y
  const drag = onGround ? GROUND_DRAG : DRAG
  const stop = (value) => (Math.abs(value) < REST ? 0 : value)
  const result = new Vec3(
    stop(moved.x === speed.x ? speed.x * drag : 0),
    onGround ? 0 : speed.y * DRAG,
    stop(moved.z === speed.z ? speed.z * drag : 0),
  )
  return { position: next, velocity: result, onGround }
}

module.exports = { step }
