'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR, Vec3 } = require('./harness')

const lever = (x, z, powered = false) => [x, FLOOR, z, 'lever', { face: 'floor', powered }]
const lamp = (x, z) => [x, FLOOR, z, 'redstone_lamp', { lit: false }]
const wires = (from, to, z) => Array.from({ length: to - from + 1 }, (_, i) => [from + i, FLOOR, z, 'redstone_wire', {}])
const use = (world, place) => world.bots.sally.activateBlock(world.bots.sally.blockAt(new Vec3(...place)))
const lit = (world, x, z) => world.block(x, FLOOR, z).properties.lit

test('a wire carries power over 15 blocks, and a lamp goes dark 4 ticks after it lost power', async () => {
  const line = wires(-7, 9, 3).slice(0, 16)
  await inWorld({ blocks: [lever(-8, 3), ...line, lamp(7, 4), lamp(8, 4)], agents: { sally: agent([-6.5, FLOOR, 1.5]) } }, async world => {
    await world.during(use(world, [-8, FLOOR, 3]))
    await world.ticks(1)
    assert.deepEqual(line.map(([x]) => world.block(x, FLOOR, 3).properties.power), [...Array.from({ length: 15 }, (_, i) => 15 - i), 0])
    assert.deepEqual(['east', 'west', 'north', 'south'].map(side => world.block(0, FLOOR, 3).properties[side]), ['side', 'side', 'none', 'none'])
    // A straight wire points only along itself.
    assert.deepEqual([lit(world, 7, 4), lit(world, 8, 4)], [false, false])
  })
  await inWorld({ blocks: [lever(-2, 3), ...wires(-1, 0, 3), lamp(1, 3)] }, async world => {
    await world.during(use(world, [-2, FLOOR, 3]))
    await world.ticks(1)
    assert.equal(lit(world, 1, 3), true)
    use(world, [-2, FLOOR, 3])
    await world.until(() => !world.block(0, FLOOR, 3).properties.power)
    const off = world.region.tick
    await world.until(() => !lit(world, 1, 3))
    assert.equal(world.region.tick - off, 3)
  })
})

test('an agent on a plate opens the iron door beside it; it shuts up to 20 ticks after the agent left', async () => {
  const door = ['lower', 'upper'].map((half, up) => [3, FLOOR + up, 0, 'iron_door', { half, open: false }])
  await inWorld({ blocks: [[2, FLOOR, 0, 'stone_pressure_plate', {}], ...door] }, async world => {
    const open = () => world.block(3, FLOOR + 1, 0).properties.open
    const { sally } = world.bots
    await world.during(sally.lookAt(new Vec3(10, FLOOR + 1, 0.5), true))
    sally.setControlState('forward', true)
    await world.until(open)
    sally.setControlState('forward', false)
    const pressed = world.region.tick
    await world.ticks(30)
    assert.equal(open(), true)
    sally.setControlState('back', true)
    await world.until(() => !open())
    assert.equal((world.region.tick - pressed) % 20, 0)
    assert.equal(world.block(2, FLOOR, 0).properties.powered, false)
  })
})
