'use strict'
/** Failures of skills that the tests of their effects leave out. Each message says what was found and what to do. */
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./harness')

const PLACE = [5, FLOOR, 3]
const SPOT = new Vec3(...PLACE)
const setting = (inventory, blocks = [], others = {}) => ({ agents: { sally: agent([0.5, FLOOR, 0.5], { inventory }), ...others }, blocks })
const message = async (world, name, ...args) => (await failure(world, world.skills.sally[name](...args))).message

test('arguments that a skill cannot use', async () => {
  await withSkills(setting({}, [], { anne: agent([-4.5, FLOOR, 0.5]) }), async world => {
    const { bots: { sally: bot } } = world
    for (const [expected, name, ...args] of [
      [/three finite numbers/, 'lookAt', bot, 'north'],
      [/whole number of at least 1; it is 0/, 'waitTicks', bot, 0],
      [/whole number of at least 1; it is 1.5/, 'waitTicks', bot, 1.5],
      [/condition must be a function/, 'waitUntil', bot, true],
      [/number must be a whole number/, 'waitUntil', bot, () => true, -1],
      [/entity must be an entity/, 'waitForMobRemoved', bot, 'anne'],
      [/timeout must be a number of at least 0/, 'waitForMobRemoved', bot, bot.entity, NaN],
      [/another agent; it is "bob". Agents here: anne/, 'follow', bot, 'bob'],
      [/number must be a whole number/, 'follow', bot, 'anne', 0],
      [/dist must be a number of at least 0/, 'follow', bot, 'anne', 10, -1],
      [/type must be a text/, 'emote', 'sally', ''],
      [/another agent; it is "sally"/, 'receiveItemFromOther', bot, 'sally', 'dirt', 1],
      [/name of an item/, 'giveItemToOther', bot, 'anne', 'dirrt', 1],
      [/whole number of at least 1/, 'craftItem', bot, 'chest', null, 0],
      [/text that is not empty/, 'say', bot, ' '],
      [/text that is not empty/, 'whisper', bot, 'anne', undefined],
      [/three finite numbers/, 'checkValidPosition', 'here', bot],
      [/must be bot, your own bot/, 'doNothing', 'sally']
    ]) assert.match(await message(world, name, ...args), expected, name)
    assert.deepEqual(world.emitted, [])
  })
})

test('a place where somebody stands, and a block that does not come back', async () => {
  await withSkills(setting({ dirt: 1, iron_pickaxe: 1 }, [[...PLACE, 'glass']], { anne: agent([3.5, FLOOR, 0.5]) }), async world => {
    const { bots: { sally } } = world
    assert.match(await message(world, 'placeItem', sally, 'dirt', new Vec3(3, FLOOR, 0)), /somebody stands there/)
    assert.match(await message(world, 'givePlacedItemBack', sally, 'glass', SPOT), /glass was removed, but it did not come back/)
    assert.equal((await world.has('sally')).dirt, 1)
  })
})

test('a furnace that is in use', async () => {
  await withSkills(setting({ raw_iron: 2, raw_gold: 1, coal: 2, oak_planks: 4 }, [[...PLACE, 'furnace']]), async world => {
    const { bots: { sally } } = world
    const furnace = async act => {
      const window = await world.during(sally.openFurnace(sally.blockAt(SPOT)))
      await world.during(act(window))
      window.close()
      await world.ticks(1)
    }
    await world.during(world.skills.sally.goToPosition(sally, SPOT, 2))
    const { itemsByName } = sally.registry
    await furnace(window => window.putInput(itemsByName.raw_gold.id, null, 1))
    assert.match(await message(world, 'smeltItem', sally, 'raw_iron', 'coal', SPOT, 1), /busy with raw_gold. Take it out first/)
    await furnace(window => window.takeInput())
    await furnace(window => window.putFuel(itemsByName.oak_planks.id, null, 1))
    assert.match(await message(world, 'smeltItem', sally, 'raw_iron', 'coal', SPOT, 1), /has oak_planks as fuel/)
  })
})

test('a bed that somebody lies in', async () => {
  const bed = [['foot', 5], ['head', 6]].map(([part, x]) => [x, FLOOR, 3, 'red_bed', { part, facing: 'east', occupied: true }])
  await withSkills(setting({}, bed), async world => {
    assert.match(await message(world, 'sleep', world.bots.sally, SPOT, 10), /somebody lies in the bed at \(5, -51, 3\)/)
  })
})
