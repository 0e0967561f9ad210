/** Labels that do not lie over each other. */

const TRIES = 8

/**
 * @param {object[]} taken - boxes that are taken: left, top, width, height
 * @param {object} wanted - the box that is wanted
 * @returns {object} the nearest free box above it or below it
 */
export function apart (taken, wanted) {
  for (let step = 0; step <= TRIES; step++) {
    for (const direction of step === 0 ? [0] : [-1, 1]) {
      const box = { ...wanted, top: wanted.top + direction * step * wanted.height }
      if (!taken.some(other => overlap(box, other))) return box
    }
  }
  return wanted
}

function overlap (one, other) {
  return one.left < other.left + other.width && other.left < one.left + one.width &&
    one.top < other.top + other.height && other.top < one.top + one.height
}
