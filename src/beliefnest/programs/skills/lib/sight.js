'use strict'
/**
 * Whether something can be used from an eye: near enough, and with a free line to it. Blocks are in the way where
 * their boxes are, glass as well; what has no box is not. Coordinates in blocks, of whatever frame the eye is in.
 */

/** How far the middle of a block may be from the eye. */
const REACH = 6
/** How high above their feet people who stand have their eyes. */
const EYE_HEIGHT = 1.62
const SNEAKING_EYES = 1.27
/** How much of a line may lie within a box: touching is not entering. */
const TOUCH = 1e-9
const CUBE = [[0, 0, 0, 1, 1, 1]]
const AXES = ['x', 'y', 'z']
/** Where on each face lines end, as parts of its edges. */
const GRID = [0.01, 0.25, 0.5, 0.75, 0.99]
/** Points within the block that lines may end in, from its middle. */
const INNER = [[0, 0, 0], [0.45, 0, 0], [-0.45, 0, 0], [0, 0.45, 0], [0, -0.45, 0], [0, 0, 0.45], [0, 0, -0.45]]

const listOf = ({ x, y, z }) => [x, y, z]

/** The boxes of a block in the world, cut at its upper side: fences are not higher to a hand. */
function boxesAt (shapes, [x, y, z]) {
  return shapes.filter(shape => shape[1] < 1).map(([x0, y0, z0, x1, y1, z1]) => [x + x0, y + y0, z + z0, x + x1, y + Math.min(y1, 1), z + z1])
}

/** The boxes of all blocks that lines from the eye to a block can meet, but for its own. */
function between (shapesAt, eye, block) {
  const [low, high] = [Math.min, Math.max].map(pick => eye.map((value, axis) => pick(Math.floor(value), block[axis])))
  const boxes = []
  for (let x = low[0]; x <= high[0]; x++) {
    for (let y = low[1]; y <= high[1]; y++) {
      for (let z = low[2]; z <= high[2]; z++) {
        if (x !== block[0] || y !== block[1] || z !== block[2]) boxes.push(...boxesAt(shapesAt(x, y, z), [x, y, z]))
      }
    }
  }
  return boxes
}

/** Whether the line between two points goes through the inside of a box. */
function enters (from, to, box) {
  let [begin, end, length] = [0, 1, 0]
  for (let axis = 0; axis < 3; axis++) {
    const way = to[axis] - from[axis]
    length = Math.hypot(length, way)
    if (way === 0) {
      if (from[axis] <= box[axis] || from[axis] >= box[axis + 3]) return false
      continue
    }
    const [a, b] = [(box[axis] - from[axis]) / way, (box[axis + 3] - from[axis]) / way]
    begin = Math.max(begin, Math.min(a, b))
    end = Math.min(end, Math.max(a, b))
  }
  return (end - begin) * length > TOUCH
}

/** Points on those faces of a box that are turned to the eye. */
function * facePoints (eye, box) {
  for (let axis = 0; axis < 3; axis++) {
    const side = eye[axis] < box[axis] ? axis : eye[axis] > box[axis + 3] ? axis + 3 : null
    if (side === null) continue
    const [first, second] = [0, 1, 2].filter(other => other !== axis)
    for (const u of GRID) {
      for (const v of GRID) {
        const point = [0, 0, 0]
        point[axis] = box[side]
        point[first] = box[first] + u * (box[first + 3] - box[first])
        point[second] = box[second] + v * (box[second + 3] - box[second])
        yield point
      }
    }
  }
}

function * targets (eye, boxes, [x, y, z]) {
  for (const [dx, dy, dz] of INNER) yield [x + 0.5 + dx, y + 0.5 + dy, z + 0.5 + dz]
  for (const box of boxes) yield * facePoints(eye, box)
}

/**
 * Whether there is a free line from an eye to a block: to a face of one of its boxes, or to a point within it.
 * @param {(x: number, y: number, z: number) => number[][]} shapesAt boxes of a block, from 0 to 1
 * @param {{x: number, y: number, z: number}} from the eye
 * @param {{x: number, y: number, z: number}} position of the block
 */
function sees (shapesAt, from, position) {
  const [eye, block] = [listOf(from), listOf(position)]
  const own = boxesAt(shapesAt(...block), block)
  const obstacles = between(shapesAt, eye, block)
  for (const point of targets(eye, own.length > 0 ? own : boxesAt(CUBE, block), block)) {
    if (!obstacles.some(box => enters(eye, point, box))) return true
  }
  return false
}

/** How far the middle of a block is from an eye. */
function distanceTo (eye, block) {
  return Math.hypot(...AXES.map(axis => block[axis] + 0.5 - eye[axis]))
}

const inReach = (eye, block) => distanceTo(eye, block) <= REACH

/** @returns {string | null} why a block cannot be used from an eye; null if it can. Arguments as of `sees` */
function hindrance (shapesAt, eye, block) {
  if (!inReach(eye, block)) return `it is ${distanceTo(eye, block).toFixed(1)} blocks away, an arm reaches ${REACH}`
  return sees(shapesAt, eye, block) ? null : 'no free line of sight'
}

/** Where the eye of somebody is whose feet are at a position. */
const eyeAbove = (feet, sneaks) => feet.offset(0, sneaks ? SNEAKING_EYES : EYE_HEIGHT, 0)

/** Boxes of the blocks that a bot knows, as `sees` asks for them. */
const shapesOf = bot => (x, y, z) => bot.world.blockIn(x, y, z)?.shapes ?? []

/** @returns {string | null} as `hindrance`, for a bot as it stands and for the blocks it knows */
function hindranceOf (bot, position, place = bot.entity.position) {
  return hindrance(shapesOf(bot), eyeAbove(place, bot.getControlState('sneak')), position)
}

module.exports = { EYE_HEIGHT, boxesAt, enters, eyeAbove, hindrance, hindranceOf, inReach, sees, shapesOf }
