/** Plan of a wide world: the ground as it is seen from a storey downwards, one pixel for each column. */

const STEEP = 0.12
const SLOPES = 3

/** Colour of a text such as "#a08363" as three numbers. */
function partsOf (text) {
  return [1, 3, 5].map(at => parseInt(text.slice(at, at + 2), 16))
}

/**
 * Paint the ground of a grid.
 * @param {ImageData} image - one pixel for each column of the part
 * @param {object} ground - `run`; `part`, its columns to paint; `grid`, numbers of block states, -1 unknown; `layer`, the highest
 *   layer that is looked at; `seen`, 1 for cells that are seen, or null: all
 * @param {object} tones - colours of what is unknown or nowhere
 */
export function paintRelief (image, ground, tones) {
  const { run, part, grid, layer, seen } = ground
  const [, height, depth] = run.shape
  const { low: [left, back], size: [columns, rows] } = part
  const colours = run.states.map(each => partsOf(each.colour))
  const [unknown, hatch, nowhere] = [tones.unknown, tones.hatch, tones.nowhere].map(partsOf)
  const levels = levelsOf(run, grid, layer, part)
  for (let i = 0; i < columns; i++) {
    for (let k = 0; k < rows; k++) {
      const level = levels[i * rows + k]
      const cell = ((left + i) * height + Math.max(level, 0)) * depth + back + k
      let colour = nowhere
      let light = 1
      if (level >= 0 && grid[cell] < 0) colour = (i + k) % 3 === 0 ? hatch : unknown
      else if (level >= 0) {
        colour = colours[grid[cell]]
        // Light comes from the north: slopes that rise to the south are lighter.
        const slope = k > 0 ? level - levels[i * rows + k - 1] : 0
        light = 1 + STEEP * Math.max(-SLOPES, Math.min(SLOPES, slope))
      }
      if (seen !== null && !seen[cell]) light *= 0.6
      image.data.set([...colour.map(each => Math.min(255, each * light)), 255], 4 * (k * columns + i))
    }
  }
}

/** Return for each column of a part the highest layer, from one downwards, that is not known to be air; -1: there is none. */
function levelsOf (run, grid, layer, part) {
  const [, height, depth] = run.shape
  const { low: [left, back], size: [columns, rows] } = part
  const air = Uint8Array.from(run.states, each => each.air ? 1 : 0)
  const levels = new Int16Array(columns * rows)
  for (let i = 0; i < columns; i++) {
    for (let k = 0; k < rows; k++) {
      const first = (left + i) * height * depth + back + k
      let level = layer
      for (let cell = first + layer * depth; level >= 0 && grid[cell] >= 0 && air[grid[cell]]; cell -= depth) level--
      // Below what is unknown a lower block may be known, such as the ground below a roof's height.
      levels[i * rows + k] = level >= 0 ? levelOf(grid, air, first + level * depth, depth, level) : -1
    }
  }
  return levels
}

/** Return the highest layer of a column with a known block other than air; if there is none, the given layer. */
function levelOf (grid, air, first, depth, layer) {
  for (let level = layer, cell = first; level >= 0; level--, cell -= depth) if (grid[cell] >= 0 && !air[grid[cell]]) return level
  return layer
}
