'use strict'
/** Whether somebody can have come from one place to another between two packets of their client, which may say anything. */
const { boxesAt, enters } = require('../../../../programs/skills/lib/sight')

// Blocks; as in the game's own server, nobody is so fast.
const FARTHEST = 10
// What is lower is stepped upon, and who crawls fits beneath what is higher.
const KNEES = 0.3

/**
 * @param {(x: number, y: number, z: number) => number[][]} shapesAt boxes of a block, from 0 to 1
 * @param {{x: number, y: number, z: number}} from where their feet were
 * @param {{x: number, y: number, z: number}} to where they say that their feet are
 */
function canGo (shapesAt, from, to) {
  const [begin, end] = [from, to].map(({ x, y, z }) => [x, y + KNEES, z])
  if (Math.hypot(...begin.map((value, axis) => end[axis] - value)) > FARTHEST) return false
  // Who is within a box, as when sand falls on them, may leave it.
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
