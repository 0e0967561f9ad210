'use strict'
/**
 * Random lines of sight. A slow walk along a line must confirm what the rule says about usable targets; and the server
 * must agree that targets can be used from the positions to which skills walk.
 *
 * BELIEFNEST_NIGHTLY=1 tries thousands.
 */
require('../../src/prepare').prepare()
const test = require('node:test')
const assert = require('node:assert/strict')
const { Vec3 } = require('vec3')
const { rememberBlocks } = require('../../src/blocks')
const { hindrance, sees } = require('../../../../../skills/code/lib/sight')
const { canUse } = require('../../../../../skills/code/lib/walking')
const { generator } = require('./generate')

const WORLDS = process.env.BELIEFNEST_NIGHTLY === '1' ? 4000 : 60
const LOOKS = 20
const SIZE = 7
const STEPS = 600
const KINDS = [
  ['stone', {}], ['stone', {}], ['glass', {}], ['stone_slab', {}], ['oak_stairs', {}], ['oak_fence', {}], ['oak_door', {}], ['oak_trapdoor', {}], ['chest', {}],
  ['lever', {}], ['torch', {}], ['red_bed', {}], ['iron_bars', {}], ['ladder', {}]
]

const registry = require('prismarine-registry')('1.20.4')
rememberBlocks(registry)
const World = require('prismarine-world')(registry)
const Chunk = require('prismarine-chunk')(registry)

/** Return a world with scattered blocks in random states. */
function someWorld ({ below, pick, chance }) {
  const world = new World(() => new Chunk({ minY: -64, worldHeight: 384 }))
  for (const [x, z] of [[0, 0], [-1, 0], [0, -1], [-1, -1]]) world.sync.setColumn(x, z, new Chunk({ minY: -64, worldHeight: 384 }))
  const share = pick([10, 30, 60])
  for (let x = 0; x < SIZE; x++) {
    for (let y = 0; y < SIZE; y++) {
      for (let z = 0; z < SIZE; z++) {
        const block = registry.blocksByName[pick(KINDS)[0]]
        const state = block.minStateId + below(block.maxStateId - block.minStateId + 1)
        if (chance(share)) world.sync.setBlockStateId(new Vec3(x, y, z), state)
      }
    }
  }
  return world.sync
}

/** Return true if some point of a line lies well within a box of a block, found step by step. */
function isBroken (shapesAt, eye, to, target) {
  for (let step = 0; step <= STEPS; step++) {
    const point = eye.plus(to.minus(eye).scaled(step / STEPS))
    const cell = point.floored()
    if (cell.equals(target)) continue
    const [x, y, z] = [point.x - cell.x, point.y - cell.y, point.z - cell.z]
    const inside = ([a, b, c, d, e, f]) => x > a + 1e-6 && x < d - 1e-6 && y > b + 1e-6 && y < e - 1e-6 && z > c + 1e-6 && z < f - 1e-6
    if (shapesAt(cell.x, cell.y, cell.z).some(inside)) return true
  }
  return false
}

/** Return true if any of many points of a block's cell has a free line, found by brute force. */
function isSeenSlowly (shapesAt, eye, target) {
  const parts = [0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1]
  const own = shapesAt(target.x, target.y, target.z)
  for (const [a, b, c, d, e, f] of [[0, 0, 0, 1, 1, 1], ...own]) {
    for (const u of parts) for (const v of parts) for (const w of parts) {
      const point = target.offset(a + u * (d - a), b + v * (Math.min(e, 1) - b), c + w * (f - c))
      if (!isBroken(shapesAt, eye, point, target)) return true
    }
  }
  return false
}

test('who sees has a free line, and where skills stand the server lets them act', () => {
  const seen = { yes: 0, no: 0 }
  for (let seed = 1; seed <= WORLDS; seed++) {
    const random = generator(seed)
    const world = someWorld(random)
    const shapesAt = (x, y, z) => world.blockIn(x, y, z)?.shapes ?? []
    for (let look = 0; look < LOOKS; look++) {
      const any = () => random.below(SIZE * 100) / 100 + 0.001
      const [eye, target] = [new Vec3(any(), any(), any()), new Vec3(random.below(SIZE), random.below(SIZE), random.below(SIZE))]
      const sight = sees(shapesAt, eye, target)
      seen[sight ? 'yes' : 'no'] += 1
      const where = `seed ${seed}: ${world.blockIn(target.x, target.y, target.z).name} at ${target} from ${eye}`
      if (canUse({ world }, eye, target)) assert.equal(hindrance(shapesAt, eye, target), null, where)
      if (look === 0 && sight) assert.ok(isSeenSlowly(shapesAt, eye, target), where)
    }
  }
  assert.ok(seen.yes > WORLDS && seen.no > WORLDS, JSON.stringify(seen))
})
