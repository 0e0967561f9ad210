'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR, Vec3 } = require('./harness')

const PLACE = [2, FLOOR, 0]
const CHEST = new Vec3(...PLACE)

const idOf = (bot, name) => bot.registry.itemsByName[name].id
const chestWorld = (name, agents) => ({
  blocks: [[...PLACE, name]], containers: [[...PLACE, { diamond: 3, dirt: 70 }]], agents
})
const carrying = inventory => ({ sally: agent([0.5, FLOOR, 0.5], { inventory }) })

for (const kind of ['chest', 'trapped_chest', 'barrel']) {
  test(`raw Mineflayer calls take from and store into a ${kind}, and the server reports it`, async () => {
    await inWorld(chestWorld(kind, carrying({ apple: 2 })), async world => {
      const { sally } = world.bots
      const before = world.everything()
      const chest = await world.during(sally.openContainer(sally.blockAt(CHEST)))
      await world.during(chest.withdraw(idOf(sally, 'diamond'), null, 2))
      await world.during(chest.deposit(idOf(sally, 'apple'), null, 1))
      await world.during(chest.close())
      await world.ticks(1)

      assert.deepEqual(world.container(...PLACE), { diamond: 1, dirt: 70, apple: 1 })
      assert.deepEqual(world.has('sally'), { diamond: 2, apple: 1 })
      assert.deepEqual(world.everything(), before)
      assert.deepEqual(world.events(), [
        { kind: 'open_container', actor: 'sally', detail: { position: PLACE } },
        { kind: 'get_item_from_chest', actor: 'sally', detail: { position: PLACE, items: { diamond: 2 } } },
        { kind: 'deposit_item_into_chest', actor: 'sally', detail: { position: PLACE, items: { apple: 1 } } }
      ])
    })
  })
}
