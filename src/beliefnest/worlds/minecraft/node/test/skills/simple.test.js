'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./harness')

const two = { sally: agent([0.5, FLOOR, 0.5]), anne: agent([-4.5, FLOOR, 0.5]) }
/** Four walls around (5..7, 5..7), too high to jump over. */
const cell = [5, 6, 7].flatMap(a => [[a, 4], [a, 8], [4, a], [8, a]])
  .flatMap(([x, z]) => [0, 1, 2].map(up => [x, FLOOR + up, z, 'stone']))

test('goToPosition arrives and says so', async () => {
  await withSkills({}, async world => {
    const { bots: { sally }, skills } = world
    await world.during(skills.sally.goToPosition(sally, new Vec3(7, FLOOR, -6)))
    assert.ok(sally.entity.position.distanceTo(new Vec3(7.5, FLOOR, -5.5)) <= 3)
    assert.deepEqual(world.emitted, [{ actor: 'sally', kind: 'move_to', detail: { destination: [7, FLOOR, -6] } }])
    await world.during(skills.sally.goToPosition(sally, new Vec3(3, FLOOR, 3), 0))
    assert.deepEqual(sally.entity.position.floored(), new Vec3(3, FLOOR, 3))
  })
})

test('goToPosition to a place without a way fails, says how near, and does not claim to be there', async () => {
  await withSkills({ blocks: cell }, async world => {
    const { bots: { sally }, skills } = world
    const error = await failure(world, skills.sally.goToPosition(sally, new Vec3(6, FLOOR, 6), 0))
    assert.equal(error.skill, 'goToPosition')
    assert.match(error.message, /could not reach the position at \(6, -51, 6\): there is no way to it on foot; now at .*, [\d.]+ blocks away/)
    assert.deepEqual(world.emitted, [])
  })
})

test('goToPosition arrives, also where each step of the search for a way takes longer than a tick', async () => {
  // Every first step leads away from the bot's goal.
  const wall = [-2, -1, 0, 1, 2].flatMap(z => [0, 1, 2].map(up => [1, FLOOR + up, z, 'stone']))
  await withSkills({ blocks: wall }, async world => {
    const { bots: { sally }, skills } = world
    const { movements } = sally.pathfinder
    const { getNeighbors } = movements
    const stopped = new Int32Array(new SharedArrayBuffer(4))
    movements.getNeighbors = node => {
      Atomics.wait(stopped, 0, 0, 60)
      return getNeighbors(node)
    }
    await world.during(skills.sally.goToPosition(sally, new Vec3(4, FLOOR, 0), 1))
    assert.ok(sally.entity.position.distanceTo(new Vec3(4.5, FLOOR, 0.5)) <= 2)
  })
})

test('no move costs a bot less than its length', async () => {
  const box = [[-11, FLOOR - 1, -11], [11, FLOOR + 6, 11]]
  const pillar = [0, 1, 2].map(up => [0, FLOOR + up, 0, 'stone'])
  await withSkills({ box, blocks: pillar, agents: { sally: agent([0.5, FLOOR + 3, 0.5]) } }, async world => {
    const { bots: { sally }, skills } = world
    const { movements } = sally.pathfinder
    const { getNeighbors } = movements
    const drops = []
    movements.getNeighbors = node => {
      const moves = getNeighbors(node)
      for (const { x, y, z, cost } of moves) {
        assert.ok(cost >= Math.hypot(x - node.x, y - node.y, z - node.z))
        if (y < node.y) drops.push(cost)
      }
      return moves
    }
    await world.during(skills.sally.goToPosition(sally, new Vec3(4, FLOOR, 0), 0))
    assert.equal(drops[0], Math.hypot(1, 3))
  })
})

test('goToPosition refuses what is no position', async () => {
  await withSkills({}, async world => {
    const { bots: { sally }, skills } = world
    const bad = async (...args) => (await failure(world, skills.sally.goToPosition(sally, ...args))).message
    assert.match(await bad(new Vec3(Infinity, 0, 0)), /three finite numbers/)
    assert.match(await bad(undefined), /three finite numbers/)
    assert.match(await bad(new Vec3(0, FLOOR, 0), -1), /at least 0/)
  })
})

test('levers are switched once, and only levers', async () => {
  const lever = [4, FLOOR, 4]
  await withSkills({ blocks: [[...lever, 'lever', { face: 'floor', powered: false }]] }, async world => {
    const { bots: { sally }, skills } = world
    const position = new Vec3(...lever)
    await world.during(skills.sally.turnOnLever(sally, position))
    await world.during(skills.sally.turnOnLever(sally, position))
    assert.equal((await world.block(...lever)).properties.powered, true)
    await world.during(skills.sally.turnOffLever(sally, position))
    await world.ticks(1)
    assert.equal((await world.block(...lever)).properties.powered, false)
    assert.deepEqual((await world.events('use_lever')).map(({ detail }) => detail.powered), [true, false])
    const error = await failure(world, skills.sally.turnOnLever(sally, new Vec3(0, FLOOR - 1, 3)))
    assert.match(error.message, /no lever at \(0, -52, 3\), but stone/)
  })
})

test('a lever behind a wall is not used through it', async () => {
  await withSkills({ blocks: [...cell, [6, FLOOR, 6, 'lever', { face: 'floor', powered: false }]] }, async world => {
    const { bots: { sally }, skills } = world
    const error = await failure(world, skills.sally.turnOnLever(sally, new Vec3(6, FLOOR, 6)))
    assert.match(error.message, /could not reach the lever/)
    assert.equal((await world.block(6, FLOOR, 6)).properties.powered, false)
  })
})

test('think, emote and doNothing', async () => {
  await withSkills({ agents: two }, async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    await world.during(own.think(sally, 'hm'))
    await world.during(own.emote('sally', 'nod'))
    await world.during(own.emote('anne', 'wave'))
    await world.during(own.doNothing(sally))
    assert.deepEqual(world.emitted.map(({ kind, detail }) => [kind, detail]), [
      ['think', { text: 'hm' }], ['emote', { name: 'nod' }], ['emote', { name: 'wave', other: 'anne' }]
    ])
    assert.match((await failure(world, own.emote('bob', 'wave'))).message, /"bob". Agents here: .*anne/)
    assert.match((await failure(world, own.think(sally, ''))).message, /not empty/)
  })
})

test('checkValidPosition tells where one can stand', async () => {
  await withSkills({ blocks: [[3, FLOOR, 3, 'stone'], [4, FLOOR + 1, 4, 'stone']] }, async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const valid = (x, y, z) => world.during(own.checkValidPosition(new Vec3(x, y, z), sally))
    assert.equal(await valid(2, FLOOR, 2), true)
    assert.equal(await valid(3, FLOOR, 3), false)
    assert.equal(await valid(4, FLOOR, 4), false)
    assert.equal(await valid(2, FLOOR + 1, 2), false)
  })
})
