/**
 * Surfaces of the blocks of a grid, chunk by chunk. Faces of full cubes that touch are left out, and equal neighbouring
 * faces become one rectangle ("greedy meshing"), so that a large world has few triangles and few draw calls. Liquids are
 * merged in the same way; blocks of other shapes stay single boxes.
 */

/** Width and depth of a chunk in blocks; a chunk is as high as the grid. */
export const CHUNK = 32

const NONE = 0
const SOLID = 1
const LIQUID = 2
const CLEAR = 3
const ENOUGH = 4
/** Outset of coarse faces. It closes the cracks between edges that end at each other, which would glitter while the camera moves. */
const OUTSET = 0.03
const LIQUIDS = new Set(['water', 'lava'])

/**
 * Ways in which block states are drawn, by number of the state: `merged` has `SOLID` or `LIQUID` for those with merged faces,
 * `boxed` has `SOLID` or `CLEAR` for those with boxes of their own.
 */
export class Kinds {
  constructor (states) {
    this.count = states.length
    this.merged = Uint8Array.from(states, mergedAs)
    this.boxed = Uint8Array.from(states, (each, number) => each.air || this.merged[number] !== NONE ? NONE : each.glassy && !each.container ? CLEAR : SOLID)
    this.boxes = states.map(each => each.boxes)
  }
}

function mergedAs ({ name, boxes, glassy }) {
  if (LIQUIDS.has(name)) return LIQUID
  const isCube = boxes.length === 1 && boxes[0].every((edge, at) => edge === (at < 3 ? 0 : 32))
  return isCube && !glassy ? SOLID : NONE
}

/**
 * Blocks to draw.
 * @typedef {object} Blocks
 * @property {Int16Array} grid - numbers of block states, -1 unknown
 * @property {number[]} shape - width, height and depth of the grid
 * @property {number} top - number of layers to draw
 * @property {Kinds} kinds
 * @property {Uint8Array|null} seen - 1 for cells that are seen; null: all
 * @property {number} chunk - width and depth of its chunks
 * @property {number} outset - length by which faces of full cubes reach beyond their edges
 */

/** Return the numbers of the chunks of a grid whose pictures differ between two sets of blocks. @returns {number[]} */
export function changedChunks (before, now) {
  const [width, height, depth] = now.shape
  const { chunk } = now
  const across = Math.ceil(depth / chunk)
  const count = Math.ceil(width / chunk) * across
  const all = Array.from({ length: count }, (_, number) => number)
  if (before === null || before.top !== now.top || before.shape.join() !== now.shape.join() || (before.seen === null) !== (now.seen === null)) return all
  const changed = new Set()
  for (let cell = 0; cell < now.grid.length; cell++) {
    if (before.grid[cell] === now.grid[cell] && (now.seen === null || before.seen[cell] === now.seen[cell])) continue
    const [i, k] = [Math.floor(cell / (height * depth)), cell % depth]
    // A block at the edge of a chunk hides faces of the next chunk.
    for (const x of [i - 1, i, i + 1]) {
      for (const z of [k - 1, k, k + 1]) {
        if (x >= 0 && z >= 0 && x < width && z < depth) changed.add(Math.floor(x / chunk) * across + Math.floor(z / chunk))
      }
    }
  }
  return [...changed]
}

/** Return the lowest and the first higher corner of a chunk, in cells. @returns {number[][]} */
export function cornersOf ({ shape: [width, , depth], top, chunk }, number) {
  const across = Math.ceil(depth / chunk)
  const [x, z] = [Math.floor(number / across) * chunk, number % across * chunk]
  return [[x, 0, z], [Math.min(x + chunk, width), top, Math.min(z + chunk, depth)]]
}

/**
 * Return blocks of twice the size, for a picture from afar: each is the highest of the merged blocks in a cube of eight,
 * if at least half of them are merged ones. Chunks keep their numbers.
 * @param {Blocks} blocks
 * @param {Blocks|null} before - an earlier result for a grid of this shape, which is changed; null: none
 * @param {number[]} numbers - the chunks that differ from those of the earlier result
 * @returns {Blocks}
 */
export function coarser (blocks, before, numbers) {
  const shape = blocks.shape.map(size => Math.ceil(size / 2))
  const made = { ...blocks, shape, top: Math.ceil(blocks.top / 2), chunk: blocks.chunk / 2, outset: OUTSET, seen: null, grid: before?.grid ?? new Int16Array(shape[0] * shape[1] * shape[2]).fill(-1) }
  if (blocks.seen !== null) made.seen = before?.seen ?? new Uint8Array(made.grid.length)
  for (const number of numbers) {
    const [from, to] = cornersOf(made, number)
    for (let i = from[0]; i < to[0]; i++) {
      for (let j = 0; j < made.top; j++) {
        for (let k = from[2]; k < to[2]; k++) {
          const cell = highestOf(blocks, 2 * i, 2 * j, 2 * k)
          const at = (i * shape[1] + j) * shape[2] + k
          made.grid[at] = cell < 0 ? -1 : blocks.grid[cell]
          if (made.seen !== null) made.seen[at] = cell < 0 ? 0 : blocks.seen[cell]
        }
      }
    }
  }
  return made
}

/** Return the highest cell with a merged block in a cube of eight; -1 if less than half of these have one. */
function highestOf ({ grid, shape: [width, height, depth], top, kinds: { merged } }, x, y, z) {
  let count = 0
  let highest = -1
  for (let j = Math.min(y + 1, top - 1); j >= y; j--) {
    for (let i = x; i < Math.min(x + 2, width); i++) {
      for (let k = z; k < Math.min(z + 2, depth); k++) {
        const cell = (i * height + j) * depth + k
        if (grid[cell] < 0 || merged[grid[cell]] === NONE) continue
        count++
        if (highest < 0) highest = cell
      }
    }
  }
  return count >= ENOUGH ? highest : -1
}

function normalOf (axis, side) {
  const normal = [0, 0, 0]
  normal[axis] = side ? 1 : -1
  return normal
}

/** Faces under construction: by corner its place, its colour, and its side: a normal, and 1 without a chequerboard. */
class Faces {
  constructor () {
    this.places = []
    this.colours = []
    this.sides = []
    this.cells = []
  }

  /**
   * Add a rectangle: its lowest corner, its two edges along the axes `u` and `v`, and the side to which it looks. It reaches
   * beyond its edges by the outset.
   */
  add (axis, side, corner, [u, wide], [v, high], colour, plain, outset = 0) {
    const [left, right, below, above] = [-outset, wide + outset, -outset, high + outset]
    const [a, b, c, d] = [[left, below], [right, below], [right, above], [left, above]].map(([along, up]) => {
      const at = [...corner]
      at[u] += along
      at[v] += up
      return at
    })
    const normal = normalOf(axis, side)
    for (const at of side ? [a, b, c, d] : [a, d, c, b]) {
      this.places.push(...at)
      this.colours.push(...colour)
      this.sides.push(...normal, plain)
    }
  }
}

/**
 * Return the merged faces of a chunk.
 * @param {Blocks} blocks
 * @param {number} number - number of the chunk
 * @param {function(number, boolean, number[]): number[]} colourOf - colour of a state, seen or not, on a side with a normal
 * @returns {{solid: Faces, liquid: Faces}}
 */
export function facesOf (blocks, number, colourOf) {
  const byKind = { solid: new Faces(), liquid: new Faces() }
  const [from, to] = cornersOf(blocks, number)
  const { merged } = blocks.kinds
  for (const axis of [0, 1, 2]) {
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3]
    const [wide, high] = [to[u] - from[u], to[v] - from[v]]
    const mask = new Int32Array(wide * high)
    for (const side of [0, 1]) {
      for (let slice = from[axis]; slice < to[axis]; slice++) {
        if (!maskOf(mask, blocks, { axis, side, slice, u, v, from, wide, high })) continue
        rectangles(mask, wide, high, (along, up, across, tall, key) => {
          const [state, unseen] = [(key - 1) >> 1, (key - 1) & 1]
          const corner = []
          corner[axis] = slice + side
          corner[u] = from[u] + along
          corner[v] = from[v] + up
          const isLiquid = merged[state] === LIQUID
          const faces = isLiquid ? byKind.liquid : byKind.solid
          // Transparent faces have no outset: overlaps would be darker.
          const outset = isLiquid ? 0 : blocks.outset
          faces.add(axis, side, corner, [u, across], [v, tall], colourOf(state, unseen === 0, normalOf(axis, side)), unseen, outset)
        })
      }
    }
  }
  return byKind
}

/**
 * Fill a mask with the visible faces of one slice: 0 where there is none, else 1 + 2 * state + (1 if unseen).
 * @returns {boolean} true if there is any
 */
function maskOf (mask, { grid, shape, top, kinds: { merged }, seen }, { axis, side, slice, u, v, from, wide, high }) {
  const strides = [shape[1] * shape[2], shape[2], 1]
  const limits = [shape[0], top, shape[2]]
  const isBottom = axis === 1 && side === 0
  const isEdge = slice === (side ? limits[axis] - 1 : 0)
  const next = side ? strides[axis] : -strides[axis]
  const first = slice * strides[axis] + from[u] * strides[u] + from[v] * strides[v]
  let any = false
  for (let up = 0, at = 0; up < high; up++) {
    let cell = first + up * strides[v]
    for (let along = 0; along < wide; along++, at++, cell += strides[u]) {
      const state = grid[cell]
      mask[at] = 0
      if (state < 0 || merged[state] === NONE) continue
      const other = isEdge ? -1 : grid[cell + next]
      // Nobody looks from below at what is unknown below.
      const isHidden = other < 0 ? isBottom : merged[other] !== NONE && merged[other] <= merged[state]
      if (isHidden) continue
      mask[at] = 1 + 2 * state + (seen !== null && !seen[cell] ? 1 : 0)
      any = true
    }
  }
  return any
}

/** Call `put` with the largest rectangles of equal marks, row by row, and clear them from the mask. */
function rectangles (mask, wide, high, put) {
  for (let up = 0; up < high; up++) {
    for (let along = 0; along < wide; along++) {
      const key = mask[up * wide + along]
      if (key === 0) continue
      let across = 1
      while (along + across < wide && mask[up * wide + along + across] === key) across++
      let tall = 1
      while (up + tall < high && isAll(mask, (up + tall) * wide + along, across, key)) tall++
      for (let row = up; row < up + tall; row++) mask.fill(0, row * wide + along, row * wide + along + across)
      put(along, up, across, tall, key)
    }
  }
}

function isAll (mask, from, count, key) {
  for (let at = from; at < from + count; at++) if (mask[at] !== key) return false
  return true
}

/**
 * Return the faces of the blocks of a chunk that are drawn as boxes, without those that touch a full cube or the same box
 * next to them. `cells` of the result has the cell of each face.
 * @param {Blocks} blocks
 * @param {number} number - number of the chunk
 * @param {function(number, boolean, number[], boolean): number[]} colourOf - colour of a state, seen or not, on a side with a
 *   normal, in a dark field of the chequerboard or not
 * @returns {{solid: Faces, clear: Faces}}
 */
export function boxesOf (blocks, number, colourOf) {
  const { grid, shape: [width, height, depth], top, kinds, seen } = blocks
  const [from, to] = cornersOf(blocks, number)
  const [strides, limits] = [[height * depth, depth, 1], [width, top, depth]]
  const byKind = { solid: new Faces(), clear: new Faces() }
  for (let i = from[0]; i < to[0]; i++) {
    for (let j = 0; j < top; j++) {
      for (let k = from[2]; k < to[2]; k++) {
        const cell = (i * height + j) * depth + k
        const state = grid[cell]
        if (state < 0 || kinds.boxed[state] === NONE) continue
        const place = [i, j, k]
        const isSeen = seen === null || seen[cell] === 1
        const isDark = isSeen && (i + k) % 2 === 0
        const isSolid = kinds.boxed[state] === SOLID
        const faces = isSolid ? byKind.solid : byKind.clear
        for (const box of kinds.boxes[state]) {
          for (const axis of [0, 1, 2]) {
            for (const side of [0, 1]) {
              const isEdge = place[axis] === (side ? limits[axis] - 1 : 0)
              const next = isEdge ? -1 : grid[cell + (side ? strides[axis] : -strides[axis])]
              const touches = box[axis + 3 * side] === 32 * side
              const goesOn = isSolid && next === state && box[axis] === 0 && box[axis + 3] === 32
              if (next >= 0 && touches && (kinds.merged[next] === SOLID || goesOn)) continue
              const corner = place.map((at, n) => at + box[n] / 32)
              corner[axis] = place[axis] + box[axis + 3 * side] / 32
              const [u, v] = [(axis + 1) % 3, (axis + 2) % 3]
              const edges = [u, v].map(along => [along, (box[along + 3] - box[along]) / 32])
              faces.add(axis, side, corner, ...edges, colourOf(state, isSeen, normalOf(axis, side), isDark), 1)
              faces.cells.push(cell)
            }
          }
        }
      }
    }
  }
  return byKind
}
