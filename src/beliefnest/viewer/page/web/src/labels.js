/** Placement of labels without overlaps. */

const TRIES = 8

/**
 * Return the free box nearest to the wanted one, above or below it.
 * @param {object[]} taken - boxes of other labels: left, top, width, height
 * @param {object} wanted - the wanted box
 * @returns {object}
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
