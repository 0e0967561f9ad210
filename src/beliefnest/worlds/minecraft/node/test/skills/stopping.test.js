'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { stopBot } = require('../../src/bots/bot')
const { agent, withSkills, FLOOR, Vec3 } = require('./harness')

const FURNACE = [3, FLOOR, 3]

test('a skill does nothing more once its program has ended', async () => {
  const abort = new AbortController()
  await withSkills({
    signal: abort.signal,
    agents: { sally: agent([0.5, FLOOR, 0.5], { inventory: { raw_iron: 2, coal: 2 } }) },
    blocks: [[...FURNACE, 'furnace']]
  }, async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const smelting = own.smeltItem(sally, 'raw_iron', 'coal', new Vec3(...FURNACE), 2)
    await world.until(async () => (await world.block(...FURNACE)).properties.lit)
    abort.abort()
    stopBot(sally)
    await assert.rejects(world.during(smelting), { skill: 'smeltItem', message: /program that called it has ended/ })
    const items = await world.has('sally')
    await world.ticks(500)
    assert.equal((await world.container(...FURNACE)).iron_ingot, 2)
    assert.deepEqual(await world.everything(), { coal: 1, iron_ingot: 2 })
    assert.deepEqual([await world.has('sally'), world.emitted, sally.currentWindow], [items, [], null])
  })
})

test('who is stopped in a doorway stands there, and the world goes on', async () => {
  const abort = new AbortController()
  const high = [0, FLOOR + 2, 3, 'stone']
  const wall = Array.from({ length: 23 }, (_, i) => i - 11).filter(x => x !== 0)
    .flatMap(x => [0, 1, 2].map(up => [x, FLOOR + up, 3, 'stone']))
  const door = ['lower', 'upper'].map((half, up) => [0, FLOOR + up, 3, 'oak_door', { half, open: false, facing: 'north' }])
  await withSkills({ signal: abort.signal, blocks: [high, ...wall, ...door] }, async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const going = assert.rejects(own.goToPosition(sally, new Vec3(0, FLOOR, 7), 1), { message: /program that called it has ended/ })
    // The bot's own tick stops it: over TCP a busy machine would let it arrive before it is asked.
    sally.on('physicsTick', () => {
      const door = sally.blockAt(new Vec3(0, FLOOR, 3))
      if (abort.signal.aborted || !sally.getControlState('forward') || !door?.getProperties().open) return
      abort.abort()
      stopBot(sally)
    })
    await world.until(async () => abort.signal.aborted)
    await world.ticks(60)
    await world.during(going)
    const stood = sally.entity.position.clone()
    // A busy machine makes several steps at once before the bot learns that the program has ended.
    if (world.isVirtual) assert.ok(stood.z < 5)
    await world.ticks(20)
    assert.deepEqual(sally.entity.position, stood)
  })
})
