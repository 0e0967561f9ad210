'use strict'
/**
 * Plausibility of movements: whether a player can have moved from one position to another between two packets. A
 * client may send anything.
 */
const { boxesAt, enters } = require('../../../../../skills/code/lib/sight')

// Largest distance in blocks; as in the game's own server, no player is faster.
const FARTHEST = 10
// Players step on lower obstacles, and crawl below higher ones.
const KNEES = 0.3

/**
 * Return true if a player can have moved straight from one position to another.
 * @param {(x: number, y: number, z: number) => number[][]} shapesAt returns the boxes of a block, from 0 to 1
 * @param {{x: number, y: number, z: number}} from old position of the feet
 * @param {{x: number, y: number, z: number}} to new position of the feet
 */
function canGo (shapesAt, from, to) {
  const [begin, end] = [from, to].map(({ x, y, z }) => [x, y + KNEES, z])
  if (Math.hypot(...begin.map((value, axis) => end[axis] - value)) > FARTHEST) return false
  // A player inside a box, for instance after sand has fallen on them, may leave it.
  return !boxesBetween(shapesAt, begin, end).some(box => !holds(box, begin) && enters(begin, end, box))
}

function boxesBetween (shapesAt, begin, end) {
  const [low, high] = [Math.min, Math.max].map(pick => begin.map((value, axis) => Math.floor(pick(value, end[axis]))))
  const boxes = []
  for (let x = low[0]; x <= high[0]; x++) {
    for (let y = low[1]; y <= high[1]; y++) {
      for (let z = low[2]; z <= high[2]; z++) boxes.push(...boxesAt(shapesAt(x, y, z), [x, y, z]))
    }
  }
  return boxes
}

function holds (box, point) {
  return point.every((value, axis) => value > box[axis] && value < box[axis + 3])
}

module.exports = { canGo }
