'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { inWorld, FLOOR, Vec3 } = require('./harness')

const PLACE = [2, FLOOR, 0]
const use = (world, place) => world.bots.sally.activateBlock(world.bots.sally.blockAt(new Vec3(...place)))

test('a lever toggles and stays, and the server says who did it', async () => {
  await inWorld({ blocks: [[...PLACE, 'lever', { face: 'floor', powered: false }]] }, async world => {
    await world.during(use(world, PLACE))
    await world.ticks(60)
    assert.equal(world.block(...PLACE).properties.powered, true)
    assert.equal(world.bots.sally.blockAt(new Vec3(...PLACE)).getProperties().powered, true)
    await world.during(use(world, PLACE))
    await world.ticks(1)
    assert.deepEqual(world.events(), [true, false].map(powered => (
      { kind: 'use_lever', actor: 'sally', detail: { position: PLACE, powered } })))
  })
})

for (const [name, expected] of [['stone_button', 20], ['oak_button', 30]]) {
  test(`a ${name} comes out again after ${expected} ticks`, async () => {
    await inWorld({ blocks: [[...PLACE, name, { face: 'floor', powered: false }]] }, async world => {
      use(world, PLACE)
      await world.until(() => world.block(...PLACE).properties.powered)
      const pushed = world.region.tick
      await world.until(() => !world.block(...PLACE).properties.powered)
      // The push is handled before the countdown of its tick.
      assert.equal(world.region.tick - pushed, expected - 1)
    })
  })
}

test('both halves of a door open, an iron door does not', async () => {
  const door = (x, name) => [[x, FLOOR, 0, name, { half: 'lower', open: false }], [x, FLOOR + 1, 0, name, { half: 'upper', open: false }]]
  await inWorld({ blocks: [...door(2, 'oak_door'), ...door(-2, 'iron_door')] }, async world => {
    const open = x => [0, 1].map(up => world.block(x, FLOOR + up, 0).properties.open)
    await world.during(use(world, PLACE))
    await world.during(use(world, [-2, FLOOR, 0]))
    await world.ticks(1)
    assert.deepEqual([open(2), open(-2)], [[true, true], [false, false]])
    await world.during(use(world, [2, FLOOR + 1, 0]))
    await world.ticks(1)
    assert.deepEqual(open(2), [false, false])
    assert.deepEqual(world.events(), [true, false].map(open => (
      { kind: 'use_door', actor: 'sally', detail: { position: [2, FLOOR, 0], open } })))
  })
})

test('trapdoors and gates open; a gate opens away from who opens it', async () => {
  await inWorld({
    blocks: [[...PLACE, 'oak_trapdoor', { open: false }], [0, FLOOR, -2, 'oak_fence_gate', { facing: 'south', open: false }],
      [-2, FLOOR, 0, 'iron_trapdoor', { open: false }]]
  }, async world => {
    await world.during(use(world, PLACE))
    await world.during(use(world, [-2, FLOOR, 0]))
    await world.ticks(1)
    await world.during(world.bots.sally.lookAt(new Vec3(0.5, FLOOR + 1, -1.5), true))
    await world.during(use(world, [0, FLOOR, -2]))
    await world.ticks(1)
    assert.equal(world.block(...PLACE).properties.open, true)
    assert.equal(world.block(-2, FLOOR, 0).properties.open, false)
    assert.deepEqual([world.block(0, FLOOR, -2).properties.open, world.block(0, FLOOR, -2).properties.facing], [true, 'north'])
    assert.deepEqual(world.events().map(({ kind, detail }) => [kind, detail]), [PLACE, [0, FLOOR, -2]].map(position => [
      'use_door', { position, open: true }]))
  })
})

test('a lever opens an iron door beside its wall and lights a lamp, and shuts them again', async () => {
  const door = ['lower', 'upper'].map((half, up) => [3, FLOOR + up, 2, 'iron_door', { half, open: false }])
  await inWorld({
    blocks: [[2, FLOOR, 2, 'stone'], [2, FLOOR, 1, 'lever', { face: 'wall', facing: 'north', powered: false }],
      [2, FLOOR, 3, 'redstone_lamp', { lit: false }], [4, FLOOR, 6, 'redstone_lamp', { lit: false }], ...door]
  }, async world => {
    const state = () => [world.block(3, FLOOR, 2).properties.open, world.block(3, FLOOR + 1, 2).properties.open,
      world.block(2, FLOOR, 3).properties.lit, world.block(4, FLOOR, 6).properties.lit]
    await world.during(use(world, [2, FLOOR, 1]))
    await world.ticks(1)
    assert.deepEqual(state(), [true, true, true, false])
    assert.deepEqual(world.events().map(({ kind }) => kind), ['use_lever'])
    await world.during(use(world, [2, FLOOR, 1]))
    // The lamp goes dark later than the door shuts.
    await world.ticks(4)
    assert.deepEqual(state(), [false, false, false, false])
    await world.during(use(world, [2, FLOOR, 1]))
    world.serv.mine(world.players.sally, world.at(2, FLOOR, 1))
    await world.ticks(4)
    assert.deepEqual(state(), [false, false, false, false])
  })
})

test('a wooden door opened by hand is not shut by a lever elsewhere', async () => {
  const door = ['lower', 'upper'].map((half, up) => [3, FLOOR + up, 2, 'oak_door', { half, open: true, powered: false }])
  await inWorld({ blocks: [...door, [-2, FLOOR, 0, 'lever', { face: 'floor', powered: false }]] }, async world => {
    await world.during(use(world, [-2, FLOOR, 0]))
    await world.ticks(1)
    assert.equal(world.block(3, FLOOR, 2).properties.open, true)
  })
})
