'use strict'
/** Programs as agents write them, in the sandbox: their effects, and the messages for their authors. */
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, withSkills, FLOOR } = require('./harness')

const setting = {
  agents: {
    sally: agent([0.5, FLOOR, 0.5], { inventory: { oak_log: 2, diamond: 1, bread: 1 }, food: 10 }),
    anne: agent([6.5, FLOOR, -4.5], { inventory: { dirt: 3 } })
  },
  blocks: [[4, FLOOR, 3, 'chest'], [-3, FLOOR, 2, 'lever', { face: 'floor', powered: false }], [-5, FLOOR, -3, 'dirt']],
  containers: [[4, FLOOR, 3, { apple: 3 }]]
}
const at = (x, z) => `new Vec3(${x}, ${FLOOR}, ${z})`

test('a long program of many skills does all of them', async () => {
  await withSkills(setting, async world => {
    const before = await world.everything()
    const { sally } = await world.run({
      sally: `
        await eat(bot, 'bread')
        await craftItem(bot, 'oak_planks', null, 4)
        await getItemFromChest(bot, ${at(4, 3)}, { apple: 2 })
        await depositItemIntoChest(bot, ${at(4, 3)}, { oak_planks: 3 })
        await turnOnLever(bot, ${at(-3, 2)})
        await mineBlock(bot, ${at(-5, -3)}, 'dirt')
        await placeItem(bot, 'dirt', ${at(-4, -4)})
        await think(bot, 'done')
        await goToPosition(bot, ${at(0, 0)}, 1)`
    })
    assert.deepEqual([sally.ok, sally.error], [true, null])
    const { bread, oak_log: logs, ...rest } = before
    assert.deepEqual([bread, logs], [1, 2])
    assert.deepEqual(await world.everything(), { ...rest, oak_log: 1, oak_planks: 4 })
    assert.deepEqual(await world.container(4, FLOOR, 3), { apple: 1, oak_planks: 3 })
    assert.equal((await world.block(-4, FLOOR, -4)).name, 'dirt')
    assert.equal((await world.block(-3, FLOOR, 2)).properties.powered, true)
    assert.deepEqual(world.emitted.map(({ kind }) => kind), ['think', 'move_to'])
  })
})

test('two programs hand something over', async () => {
  await withSkills(setting, async world => {
    const { sally, anne } = await world.run({
      sally: "await giveItemToOther(bot, 'anne', 'diamond', 1)\nawait say(bot, 'yours')",
      anne: "await receiveItemFromOther(bot, 'sally', 'diamond', 1)\nawait equip(bot, 'diamond')"
    })
    assert.deepEqual([sally.error, anne.error], [null, null])
    assert.deepEqual(await world.has('anne'), { diamond: 1, dirt: 3 })
    assert.equal((await world.player('anne')).equipment.main_hand, 'diamond')
  })
})

test('what fails is said with its skill and its line', async () => {
  await withSkills(setting, async world => {
    const { sally } = await world.run({ sally: `await think(bot, 'a try')\nawait getItemFromChest(bot, ${at(4, 3)}, { diamond: 1 })\nawait think(bot, 'never')` })
    const { skill, line, message } = sally.error
    assert.deepEqual([sally.ok, skill, line], [false, 'getItemFromChest', 2])
    assert.match(message, /1 diamond asked for .* it holds 0/)
    assert.equal(world.emitted.length, 1)
  })
})

test('a program that takes too long is stopped, and the next one runs', async () => {
  await withSkills(setting, async world => {
    const { sally } = await world.run({ sally: `for (;;) { await goToPosition(bot, ${at(8, 8)}, 0); await goToPosition(bot, ${at(-8, -8)}, 0) }` }, 40)
    assert.deepEqual([sally.ok, sally.error.kind], [false, 'timeout'])
    const next = await world.run({ sally: `await goToPosition(bot, ${at(1, 1)}, 0)` })
    assert.equal(next.sally.error, null)
    const [x, , z] = (await world.player('sally')).position.map(Math.floor)
    assert.deepEqual([x, z], [1, 1])
  })
})
