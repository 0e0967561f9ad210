'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR, Vec3 } = require('./harness')

const idOf = (bot, name) => bot.registry.itemsByName[name].id
const sally = inventory => ({ sally: agent([0.5, FLOOR, 0.5], { inventory }) })
const PLACE = [2, FLOOR, 0]

test('crafting in the inventory', async () => {
  await inWorld({ agents: sally({ oak_log: 3 }) }, async world => {
    const bot = world.bots.sally
    const [recipe] = bot.recipesFor(idOf(bot, 'oak_planks'), null, 1, null)
    await world.during(bot.craft(recipe, 2, null))
    await world.ticks(1)
    assert.deepEqual(world.has('sally'), { oak_log: 1, oak_planks: 8 })
    assert.equal(bot.inventory.count(idOf(bot, 'oak_planks')), 8)
  })
})

test('crafting at a table', async () => {
  await inWorld({ agents: sally({ oak_planks: 20 }), blocks: [[...PLACE, 'crafting_table']] }, async world => {
    const bot = world.bots.sally
    const table = bot.blockAt(new Vec3(...PLACE))
    const [recipe] = bot.recipesFor(idOf(bot, 'chest'), null, 1, table)
    await world.during(bot.craft(recipe, 2, table))
    await world.ticks(1)
    assert.deepEqual(world.has('sally'), { chest: 2, oak_planks: 4 })
    assert.equal(bot.currentWindow, null)
  })
})

test('what lies in a grid comes back', async () => {
  await inWorld({ agents: sally({ oak_planks: 20 }), blocks: [[...PLACE, 'crafting_table']] }, async world => {
    const bot = world.bots.sally
    await world.during(bot.openBlock(bot.blockAt(new Vec3(...PLACE))))
    await world.during(bot.clickWindow(bot.inventory.items()[0].slot + 1, 0, 0))
    await world.during(bot.clickWindow(5, 1, 0))
    await world.ticks(1)
    assert.equal(bot.currentWindow.slots[0].name, 'oak_button')
    bot.closeWindow(bot.currentWindow)
    await world.ticks(1)
    assert.deepEqual(world.has('sally'), { oak_planks: 20 })
  })
})

for (const [kind, time] of [['furnace', 200], ['blast_furnace', 100]]) {
  test(`a ${kind} smelts with fuel, ${time} ticks each`, async () => {
    await inWorld({
      agents: sally({ raw_iron: 2, stick: 8 }), blocks: [[...PLACE, kind]]
    }, async world => {
      const bot = world.bots.sally
      const furnace = await world.during(bot.openFurnace(bot.blockAt(new Vec3(...PLACE))))
      await world.during(furnace.putInput(idOf(bot, 'raw_iron'), null, 2))
      await world.during(furnace.putFuel(idOf(bot, 'stick'), null, 8))
      await world.ticks(1)
      assert.equal(world.block(...PLACE).properties.lit, true)
      const start = world.region.tick
      await world.until(() => furnace.outputItem()?.count === 1)
      assert.ok(Math.abs(world.region.tick - start - time) <= 2)
      await world.until(() => furnace.outputItem()?.count === 2)
      await world.during(furnace.takeOutput())
      await world.during(furnace.close())
      await world.until(() => !world.block(...PLACE).properties.lit)
      assert.equal(world.has('sally').iron_ingot, 2)
      assert.deepEqual(world.container(...PLACE), { stick: 8 - 2 * time / 100 })
    })
  })
}

test('a furnace without fuel, and with what does not smelt, does nothing', async () => {
  await inWorld({ blocks: [[...PLACE, 'furnace'], [3, FLOOR, 0, 'smoker']], containers: [[...PLACE, { raw_iron: 2 }], [3, FLOOR, 0, { raw_iron: 1, coal: 1 }]] }, async world => {
    await world.ticks(250)
    assert.deepEqual([world.container(...PLACE), world.container(3, FLOOR, 0)], [{ raw_iron: 2 }, { coal: 1, raw_iron: 1 }])
  })
})

test('a smelter that runs alone is reported as its content changes', async () => {
  await inWorld({ blocks: [[...PLACE, 'furnace']], containers: [[...PLACE, { sand: 1, coal: 1 }]] }, async world => {
    await world.until(() => world.container(...PLACE).glass === 1)
    await world.ticks(1)
    assert.deepEqual(world.frames.flatMap(frame => frame.containers), [[...PLACE, { sand: 1 }], [...PLACE, { glass: 1 }]])
  })
})

test('a bed is lain in by one at a time', async () => {
  const bed = [[2, FLOOR, 0, 'red_bed', { part: 'foot', facing: 'east' }], [3, FLOOR, 0, 'red_bed', { part: 'head', facing: 'east' }]]
  await inWorld({ blocks: bed, agents: { ...sally({}), anne: agent([2.5, FLOOR, 2.5]) } }, async world => {
    const { sally: first, anne } = world.bots
    const lie = bot => world.during(bot.activateBlock(bot.blockAt(new Vec3(2, FLOOR, 0))))
    await lie(first)
    await lie(anne)
    await world.ticks(1)
    assert.deepEqual([first.isSleeping, anne.isSleeping], [true, false])
    assert.deepEqual([2, 3].map(x => world.block(x, FLOOR, 0).properties.occupied), [true, true])
    await world.during(first.wake())
    await world.ticks(1)
    assert.deepEqual([first.isSleeping, world.block(3, FLOOR, 0).properties.occupied], [false, false])
  })
})
