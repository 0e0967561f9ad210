/** Part of a world that pictures show: all of it, or what lies around its agents and containers. */

const WHOLE = 256
const EDGE = 24
const STEP = 16

/** Return all columns of the world of a run as a part. @returns {{low: number[], size: number[]}} */
export function wholeOf (run) {
  return { low: [0, 0], size: [run.shape[0], run.shape[2]] }
}

/**
 * Return the columns to show. A world of up to `WHOLE` blocks is shown as a whole. Of a larger one the part
 * around the things of some simulators is shown, and it grows with them, so that pictures stand still.
 * @param {object} run - run of the world
 * @param {object[]} shown - agents and containers of each shown simulator
 * @param {object|null} before - part that was shown before
 * @returns {{low: number[], size: number[]}} first column and numbers of columns along x and z, counted from the box's corner
 */
export function partToShow (run, shown, before) {
  const sides = wholeOf(run).size
  if (Math.max(...sides) <= WHOLE) return wholeOf(run)
  const corner = [run.head.box.low[0], run.head.box.low[2]]
  const points = shown.flatMap(things => [
    ...things.containers.map(each => [each.place[0], each.place[2]]),
    ...things.agents.filter(each => each.pose !== null).map(each => [each.pose.x, each.pose.z])
  ]).map(point => point.map((value, axis) => Math.floor(value) - corner[axis]))
  if (points.length === 0) return before ?? wholeOf(run)
  const spans = sides.map((side, axis) => {
    const along = points.map(point => point[axis])
    const first = Math.floor((Math.min(...along) - EDGE) / STEP) * STEP
    const end = Math.ceil((Math.max(...along) + 1 + EDGE) / STEP) * STEP
    const range = before === null ? [first, end] : [Math.min(first, before.low[axis]), Math.max(end, before.low[axis] + before.size[axis])]
    return [Math.max(0, range[0]), Math.min(side, range[1])]
  })
  return { low: spans.map(([first]) => first), size: spans.map(([first, end]) => end - first) }
}
