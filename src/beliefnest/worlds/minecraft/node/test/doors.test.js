'use strict'
/** Walks in boxes so wide that a search of all of the ground takes too long. */
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./skills/harness')

const INSIDE = new Vec3(0, FLOOR, 4)
// Nodes of a search that finds nothing, after one that was broken off.
const MOST = 64_100

/** Return the blocks of a house with a roof, and with a doorway or a door at (0, FLOOR, 0). */
function house (opening) {
  const blocks = []
  for (let x = -4; x <= 4; x++) {
    for (let z = 0; z <= 8; z++) {
      const isWall = Math.abs(x) === 4 || z === 0 || z === 8
      for (let up = 0; up < 4; up++) if (isWall && !(x === 0 && z === 0 && up < 2)) blocks.push([x, FLOOR + up, z, 'bricks'])
      blocks.push([x, FLOOR + 4, z, 'bricks'])
    }
  }
  return blocks.concat(opening)
}

const doorAt = (x, z, open = false) => ['lower', 'upper'].map((half, up) => [x, FLOOR + up, z, 'oak_door', { half, open, facing: 'north' }])
const walledUp = [0, 1].map(up => [0, FLOOR + up, 0, 'bricks'])

/**
 * Run `body(go, world)` in a box of a width, with `blocks` on its bare floor. `go(position)` walks there, and returns
 * the number of ticks that it took and of the nodes that its searches took.
 */
async function inBox (width, blocks, from, body) {
  const corner = width >> 1
  const box = [[-corner, FLOOR - 1, -corner], [width - corner - 1, FLOOR + 5, width - corner - 1]]
  await withSkills({ agents: { sally: agent(from) }, blocks, box }, async world => {
    const { bots: { sally }, skills } = world
    const searched = []
    let last = 0
    sally.on('path_update', ({ visitedNodes }) => {
      if (visitedNodes < last) searched.push(last)
      last = visitedNodes
    })
    const walk = position => skills.sally.goToPosition(sally, position, 0)
    const go = async (position, end = walking => world.during(walking)) => {
      const start = await world.tick()
      const failure = await end(walk(position))
      return { error: failure, ticks: await world.tick() - start, nodes: searched.reduce((sum, nodes) => sum + nodes, last) }
    }
    await body(go, world)
  })
}

for (const [name, open] of [['a shut', false], ['an open', true]]) {
  test(`${name} door costs the same in a wide box and in a very wide one`, async () => {
    const costs = []
    for (const width of [160, 320]) {
      await inBox(width, house(doorAt(0, 0, open)), [1.5, FLOOR, -6.5], async go => costs.push(await go(INSIDE)))
    }
    assert.deepEqual(costs[0], costs[1])
    assert.ok(costs[0].ticks < 60, String(costs[0].ticks))
    assert.ok(costs[0].nodes < 12_000, String(costs[0].nodes))
  })
}

test('a door between two halves of a wide box is gone through, and a door that leads nowhere is not', async () => {
  const wall = Array.from({ length: 300 }, (_, i) => [0, 1, 2].map(up => [i - 150, FLOOR + up, 12, 'bricks'])).flat()
    .filter(([x, y]) => x !== 7 || y >= FLOOR + 2)
  await inBox(300, [...wall, ...doorAt(7, 12), ...house(walledUp), ...doorAt(-12, 3)], [1.5, FLOOR, -6.5], async (go, world) => {
    await go(new Vec3(0, FLOOR, 16))
    assert.deepEqual((await world.events('use_door')).map(({ detail }) => detail), [{ position: [7, FLOOR, 12], open: true }])
  })
})

test('a place without a way is told after a bounded number of nodes, with doors near and without', async () => {
  for (const doors of [[], doorAt(-12, 3)]) {
    await inBox(320, house([...walledUp, ...doors]), [1.5, FLOOR, -6.5], async (go, world) => {
      const { error, nodes } = await go(INSIDE, walking => failure(world, walking))
      assert.match(error.message, /no way to it/)
      assert.ok(nodes < MOST, String(nodes))
      assert.deepEqual(await world.events('use_door'), [])
    })
  }
})

test('a search above the invisible floor of a box does not look at all heights below it', async () => {
  const pit = [-1, 0, 1].flatMap(x => [-5, -4, -3].map(z => [x, FLOOR - 1, z, 'air']))
  await inBox(24, pit, [0.5, FLOOR - 1, -3.5], async (go, { bots: { sally } }) => {
    const { blockIn } = sally.world
    let lowest = Infinity
    sally.world.blockIn = function (x, y, z) {
      lowest = Math.min(lowest, y)
      return blockIn.call(this, x, y, z)
    }
    await go(INSIDE)
    // Physics looks one block below the floor.
    assert.ok(lowest >= FLOOR - 3, String(lowest))
  })
})
