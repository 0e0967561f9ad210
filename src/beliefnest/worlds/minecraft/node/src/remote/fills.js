'use strict'
/**
 * Planner of the commands that turn a box of blocks into another one: few fills, each within the command's limit.
 *
 * The planner is greedy: from each differing cell that no fill covers yet, in array order, it grows the cuboid of equal
 * wanted states as far as possible. A minimal cover would be expensive to find and saves little on built structures.
 */

const MOST_BLOCKS = 32768

/**
 * Return fills that set all differing blocks.
 * @param {import('../regions/box').Box} box
 * @param {Int32Array} present present states, in the box's array order
 * @param {Int32Array} wanted wanted states
 * @param {(state: number) => number} rank order of the states: lower ranks are set first
 * @returns {{state: number, low: number[], high: number[]}[]} cuboids that together cover all differences, in the
 *   order of the commands
 */
function planFills (box, present, wanted, rank) {
  const open = new Uint8Array(box.size)
  for (let index = 0; index < box.size; index++) open[index] = present[index] === wanted[index] ? 0 : 1
  const cuboids = []
  box.forEach((x, y, z, index) => {
    if (open[index]) cuboids.push(grow(box, open, wanted, [x, y, z]))
  })
  return cuboids.map(cuboid => [rank(cuboid.state), cuboid])
    .sort(([a, one], [b, other]) => a - b || one.low[1] - other.low[1]).map(([, cuboid]) => cuboid)
}

/**
 * Return a large cuboid of one state that begins at a corner; it grows along z, then x, then y. Mark its cells as
 * taken.
 */
function grow (box, open, wanted, low) {
  const state = wanted[box.index(...low)]
  const high = [...low]
  const fits = (from, to) => {
    for (let x = from[0]; x <= to[0]; x++) {
      for (let y = from[1]; y <= to[1]; y++) {
        for (let z = from[2]; z <= to[2]; z++) {
          const index = box.index(x, y, z)
          if (!open[index] || wanted[index] !== state) return false
        }
      }
    }
    return true
  }
  const volume = corner => [0, 1, 2].reduce((product, axis) => product * (corner[axis] - low[axis] + 1), 1)
  for (const axis of [2, 0, 1]) {
    while (high[axis] < box.high[axis]) {
      const from = low.with(axis, high[axis] + 1)
      const to = high.with(axis, high[axis] + 1)
      if (volume(to) > MOST_BLOCKS || !fits(from, to)) break
      high[axis] += 1
    }
  }
  for (let x = low[0]; x <= high[0]; x++) {
    for (let y = low[1]; y <= high[1]; y++) {
      for (let z = low[2]; z <= high[2]; z++) open[box.index(x, y, z)] = 0
    }
  }
  return { state, low, high }
}

module.exports = { MOST_BLOCKS, planFills }
