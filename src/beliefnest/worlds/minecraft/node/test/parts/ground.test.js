'use strict'
/** Terrains as they are told, and the columns that are made of them. */
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
require('../../src/prepare').prepare()
const registry = require('prismarine-registry')('1.20.4')
const { rememberBlocks } = require('../../src/blocks')
const { Box, runsOf } = require('../../src/regions/box')
const { Ground } = require('../../src/regions/ground')
const { Terrain } = require('../../src/regions/terrain')
const { Random } = require('../../src/time/random')

rememberBlocks(registry)

const SIDE = 8
const WALL = registry.blocksByName.barrier.defaultState
const SERVER = { registry, minY: -64, worldHeight: 384 }
const random = new Random('ground')
const below = number => Math.floor(random.next() * number)

/** Return random states of a box: mostly air, with a floor, some unknown blocks, and parts that repeat. */
function statesOf (box) {
  const states = new Int32Array(box.size)
  box.forEach((x, y, z, index) => {
    if (y === box.low[1]) states[index] = 1
    else if (((x >> 4) + (z >> 5)) % 3 === 0 && below(20) === 0) states[index] = below(4) - 1
  })
  return states
}

/** Return BLOCKS in chunks that begin one cell before the box, equal ones once, as Python does. */
function cut (states, box) {
  const first = box.low.map(value => value - 1)
  const counts = box.shape.map(side => Math.ceil((side + 2) / SIDE))
  const [rows, chunks, rowsByKey] = [[], [], new Map()]
  new Box([0, 0, 0], counts.map(count => count - 1)).forEach((i, j, k) => {
    const corner = [i, j, k].map((value, axis) => first[axis] + value * SIDE)
    const cells = []
    new Box(corner, corner.map(value => value + SIDE - 1)).forEach((x, y, z) => cells.push(box.contains(x, y, z) ? states[box.index(x, y, z)] : 0))
    const key = cells.join()
    if (!rowsByKey.has(key)) rowsByKey.set(key, chunks.push(cells) - 1)
    rows.push(rowsByKey.get(key))
  })
  return { first, side: SIDE, counts, rows: runsOf(Int32Array.from(rows)), states: runsOf(Int32Array.from(chunks.flat())) }
}

const BOXES = [
  new Box([-20, -60, -5], [13, -30, 30]), new Box([0, 0, 0], [63, 9, 47]), new Box([-33, -52, 7], [40, -40, 90]), new Box([5, 300, 5], [5, 318, 5])
]

for (const box of BOXES) {
  const states = statesOf(box)
  for (const [kind, blocks] of Object.entries({ 'one chunk': runsOf(states), chunks: cut(states, box) })) {
    describe(`a box of ${box.shape.join(' x ')}, told as ${kind}`, () => {
      it('has the states that were told, and those set since', () => {
        const terrain = Terrain.read(blocks, box)
        const wanted = states.slice()
        for (let count = 0; count < 200; count++) {
          const place = box.low.map((value, axis) => value + below(box.shape[axis]))
          terrain.set(...place, wanted[box.index(...place)] = below(9) - 1)
        }
        box.forEach((x, y, z, index) => assert.equal(terrain.at(x, y, z), wanted[index]))
        assert.deepEqual(terrain.dense(), wanted)
        if (kind === 'chunks') assert.deepEqual(Terrain.read(blocks, box).dense(), states, 'another terrain does not change')
      })

      it('becomes columns with walls around them, each of its own', () => {
        const origin = { x: 64, z: -32 }
        const ground = new Ground(SERVER, { box, origin }, Terrain.read(blocks, box))
        const columns = new Map()
        const columnAt = (x, z) => {
          const key = [(x + origin.x) >> 4, (z + origin.z) >> 4]
          if (!columns.has(key.join())) columns.set(key.join(), ground.column(...key))
          return columns.get(key.join())
        }
        const within = (x, y, z) => ({ x: (x + origin.x) & 15, y, z: (z + origin.z) & 15 })
        box.grown().forEach((x, y, z) => {
          const wanted = box.contains(x, y, z) ? Math.max(states[box.index(x, y, z)], 0) : WALL
          assert.equal(columnAt(x, z).getBlockStateId(within(x, y, z)), wanted, `${x} ${y} ${z}`)
        })
        const [x, y, z] = box.low
        columnAt(x, z).setBlockStateId(within(x, y, z), 79)
        const again = ground.column((x + origin.x) >> 4, (z + origin.z) >> 4)
        assert.equal(again.getBlockStateId(within(x, y, z)), Math.max(states[0], 0))
        assert.equal(ground.column(((x - 2 + origin.x) >> 4) - 1, 0), undefined, 'nothing is beyond the walls')
      })

      it('tells where blocks of a kind are', () => {
        const indices = new Set()
        Terrain.read(blocks, box).find(state => state === 2, (x, y, z, state) => {
          assert.equal(state, 2)
          indices.add(box.index(x, y, z))
        })
        assert.deepEqual([...indices].sort((a, b) => a - b), [...states.keys()].filter(index => states[index] === 2))
      })
    })
  }
}

describe('columns of a large plain', () => {
  it('are few, however many there are', () => {
    const box = new Box([0, -52, 0], [799, -49, 799])
    const states = new Int32Array(box.size)
    box.forEach((x, y, z, index) => { if (y === -52) states[index] = 1 })
    states[box.index(400, -51, 400)] = 79
    const ground = new Ground(SERVER, { box, origin: { x: 0, z: 0 } }, Terrain.read(cut(states, box), box))
    for (let x = -1; x <= 50; x++) {
      for (let z = -1; z <= 50; z++) ground.column(x, z)
    }
    assert.ok(ground.kinds.size <= 26, `${ground.kinds.size} kinds of columns`)
  })
})

describe('chunks', () => {
  const box = BOXES[0]
  const right = cut(statesOf(box), box)
  const wrong = {
    'too few rows': { rows: right.rows.subarray(8) },
    'too few states': { states: right.states.subarray(8) },
    'a row without a chunk': { states: right.states.subarray(0, 8) },
    'an odd side': { side: 5 },
    'a box beyond them': { first: right.first.map(value => value + 40) }
  }
  for (const [what, part] of Object.entries(wrong)) {
    it(`are refused with ${what}`, () => {
      assert.throws(() => Terrain.read({ ...right, ...part }, box), { kind: 'bad_request', message: /do not fill the box/ })
    })
  }
})
