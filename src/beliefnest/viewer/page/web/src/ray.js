/** Lines of sight, judged by Python, as data for drawing. */

import { partsOf } from './run.js'
const EYE = 1.62
const MIDDLE = 0.9

/**
 * Return a line of sight for drawing.
 * @param {Array|null} look - outcome, distance, and [x, y, z, name] of the obstructing block or null
 * @returns {object|null} from, to, stop, whether the target is seen, blocker; null if there is no line
 */
export function rayOf (run, track, tick, viewer, thing, look) {
  const here = track.agent(viewer, tick)
  if (look === null || here === null || thing === null) return null
  const to = targetOf(run, track, tick, thing)
  if (to === null) return null
  const from = { x: here.x, y: here.y + EYE, z: here.z }
  const blocker = look[2] === null ? null : look[2].slice(0, 3)
  return { from, to, seen: look[0] === 'seen', blocker, stop: blocker === null ? to : entry(from, to, blocker) }
}

function targetOf (run, track, tick, thing) {
  const { kind, number } = partsOf(thing)
  if (kind === 'agent') {
    const pose = track.agent(number, tick)
    return pose && { x: pose.x, y: pose.y + MIDDLE, z: pose.z }
  }
  const [x, y, z] = run.place(number)
  return { x: x + 0.5, y: y + 0.5, z: z + 0.5 }
}

/** Return where a line enters the cell of a block. */
function entry (from, to, cell) {
  let first = 0
  ;['x', 'y', 'z'].forEach((axis, at) => {
    const step = to[axis] - from[axis]
    if (step === 0) return
    const sides = [cell[at], cell[at] + 1].map(edge => (edge - from[axis]) / step)
    first = Math.max(first, Math.min(...sides))
  })
  const share = Math.min(1, first)
  return Object.fromEntries(['x', 'y', 'z'].map(axis => [axis, from[axis] + share * (to[axis] - from[axis])]))
}

/** Return a line of sight in words. @returns {string} */
export function lookWords (run, viewer, thing, look) {
  const name = run.head.agents[viewer].name
  const target = run.thingName(thing)
  if (look === null) return `The place of ${name} is not known here.`
  const [view, distance, blocker] = look
  if (view === 'seen') return `${name} sees ${target}, ${distance} blocks away.`
  if (view === 'blocked' && blocker) {
    const [x, y, z, what] = blocker
    return `${name} does not see ${target}: the ${what ?? 'block'} at (${x}, ${y}, ${z}) is in the way.`
  }
  if (view === 'too far') return `${name} does not see ${target}: it is ${distance} blocks away, too far.`
  if (view === 'place unknown') return `The place of ${target} is not known here.`
  return `${name} does not see ${target}: ${view}.`
}
