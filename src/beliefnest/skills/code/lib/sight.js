'use strict'
/**
 * Reach and line of sight: whether an eye is near enough to use something, with a free line to it. All boxes of blocks
 * obstruct, glass too; blocks without boxes do not. Coordinates are in blocks, in the frame of the eye.
 */

/** Largest distance from the eye to the middle of a block. */
const REACH = 6
/** Height of the eyes above the feet of a standing player. */
const EYE_HEIGHT = 1.62
const SNEAKING_EYES = 1.27
/** Length of a line inside a box that still counts as touching, not as entering. */
const TOUCH = 1e-9
const CUBE = [[0, 0, 0, 1, 1, 1]]
const AXES = ['x', 'y', 'z']
/** Positions of the end points of lines on each face, as fractions of its edges. */
const GRID = [0.01, 0.25, 0.5, 0.75, 0.99]
/** End points of lines within a block, relative to its middle. */
const INNER = [[0, 0, 0], [0.45, 0, 0], [-0.45, 0, 0], [0, 0.45, 0], [0, -0.45, 0], [0, 0, 0.45], [0, 0, -0.45]]

const listOf = ({ x, y, z }) => [x, y, z]

/** Return the boxes of a block in world coordinates, cut at the block's top: fences are not higher for a hand. */
function boxesAt (shapes, [x, y, z]) {
  return shapes.filter(shape => shape[1] < 1).map(([x0, y0, z0, x1, y1, z1]) => [x + x0, y + y0, z + z0, x + x1, y + Math.min(y1, 1), z + z1])
}

/** Return the boxes of all blocks that a line from the eye to a block can meet, except those of the block itself. */
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

/** Return true if the line between two points passes through the inside of a box. */
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

/** Yield points on those faces of a box that face the eye. */
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
 * Return true if a free line leads from an eye to a block: to a face of one of its boxes, or to a point within it.
 * @param {(x: number, y: number, z: number) => number[][]} shapesAt returns the boxes of a block, from 0 to 1
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

/** Return the distance from an eye to the middle of a block. */
function distanceTo (eye, block) {
  return Math.hypot(...AXES.map(axis => block[axis] + 0.5 - eye[axis]))
}

const inReach = (eye, block) => distanceTo(eye, block) <= REACH

/**
 * Return why a block cannot be used from an eye, or null if it can. Arguments as of `sees`.
 * @returns {string | null}
 */
function hindrance (shapesAt, eye, block) {
  if (!inReach(eye, block)) return `it is ${distanceTo(eye, block).toFixed(1)} blocks away, an arm reaches ${REACH}`
  return sees(shapesAt, eye, block) ? null : 'no free line of sight'
}

/** Return the position of the eye of a player whose feet are at a position. */
const eyeAbove = (feet, sneaks) => feet.offset(0, sneaks ? SNEAKING_EYES : EYE_HEIGHT, 0)

/** Return a function that returns the boxes of a block that a bot knows, in the form that `sees` takes. */
const shapesOf = bot => (x, y, z) => bot.world.blockIn(x, y, z)?.shapes ?? []

/** Return the same as `hindrance`, for a bot where it stands and for the blocks it knows. @returns {string | null} */
function hindranceOf (bot, position, place = bot.entity.position) {
  return hindrance(shapesOf(bot), eyeAbove(place, bot.getControlState('sneak')), position)
}

module.exports = { EYE_HEIGHT, boxesAt, enters, eyeAbove, hindrance, hindranceOf, inReach, sees, shapesOf }
