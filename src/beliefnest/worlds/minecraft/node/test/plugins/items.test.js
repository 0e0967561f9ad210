'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR, Vec3 } = require('./harness')

const idOf = (bot, name) => bot.registry.itemsByName[name].id
const lying = world => world.serv.itemEntities(() => true).map(({ item }) => [item.name, item.count])
const pair = (inventory, other = {}) => ({
  sally: agent([0.5, FLOOR, 0.5], { inventory, yaw: -Math.PI / 2 }),
  anne: agent([3.5, FLOOR, 0.5], { inventory: other })
})

test('a tossed item falls, and another picks it up', async () => {
  await inWorld({ agents: pair({ diamond: 3 }) }, async world => {
    const { sally, anne } = world.bots
    await world.during(sally.toss(idOf(sally, 'diamond'), null, 2))
    await world.ticks(1)
    assert.deepEqual(lying(world).reduce((sum, [, count]) => sum + count, 0), 2)
    const seen = Object.values(anne.entities).find(entity => entity.name === 'item')
    assert.equal(seen.getDroppedItem().name, 'diamond')
    await world.until(() => world.has('anne').diamond === 2)
    assert.deepEqual([lying(world), world.has('sally')], [[], { diamond: 1 }])
    await world.until(() => anne.inventory.count(idOf(anne, 'diamond'), null) === 2)
    const items = world.frames.flatMap(frame => Object.values(frame.items))
    assert.ok(items.some(item => item?.name === 'diamond' && item.position[1] < FLOOR + 0.1))
    assert.equal(items.at(-1), null)
  })
})

test('an item is not picked up at once', async () => {
  await inWorld({ agents: pair({ diamond: 1 }) }, async world => {
    await world.during(world.bots.sally.lookAt(new Vec3(0.5, FLOOR, 0.6), true))
    await world.during(world.bots.sally.toss(idOf(world.bots.sally, 'diamond'), null, 1))
    await world.ticks(30)
    assert.deepEqual(lying(world), [['diamond', 1]])
    await world.until(() => lying(world).length === 0)
  })
})

test('what does not fit stays on the ground', async () => {
  await inWorld({ agents: pair({ dirt: 64 }, { stone: 35 * 64, dirt: 60 }) }, async world => {
    const before = world.everything()
    const { sally } = world.bots
    await world.during(sally.tossStack(sally.inventory.items()[0]))
    await world.until(() => world.has('anne').dirt === 64)
    await world.ticks(20)
    assert.deepEqual(lying(world), [['dirt', 60]])
    assert.deepEqual(world.everything(), before)
  })
})

test('equal items that lie together become one stack', async () => {
  await inWorld({ agents: pair({}) }, async world => {
    const drop = count => world.serv.dropItem(world.at(-5.5, FLOOR, 5.5), new world.serv.Item(1, count))
    drop(40)
    drop(20)
    drop(30)
    await world.ticks(10)
    assert.deepEqual(lying(world).map(([, count]) => count).sort(), [30, 60])
  })
})

test('items lie on slabs and do not go through walls', async () => {
  await inWorld({ agents: pair({}), blocks: [[5, FLOOR, 5, 'stone_slab', { type: 'bottom' }], [7, FLOOR, 5, 'stone']] }, async world => {
    const item = new world.serv.Item(1, 1)
    const slab = world.serv.dropItem(world.at(5.5, FLOOR + 1.5, 5.5), item)
    const wall = world.serv.dropItem(world.at(6.5, FLOOR + 0.2, 5.5), item, { velocity: new Vec3(0.4, 0, 0) })
    await world.ticks(60)
    assert.equal(slab.position.y, FLOOR + 0.5)
    assert.ok(world.region.toScenario(wall.position)[0] <= 6.875)
    assert.equal(wall.position.y, FLOOR)
  })
})

test('items vanish after five minutes', async () => {
  await inWorld({ agents: pair({}) }, async world => {
    world.serv.dropItem(world.at(8.5, FLOOR, 8.5), new world.serv.Item(1, 1)).born = world.region.tick - 5990
    await world.ticks(9)
    assert.equal(lying(world).length, 1)
    await world.ticks(1)
    assert.equal(lying(world).length, 0)
  })
})

test('what somebody wears and holds is shown, from the start and when it changes', async () => {
  const start = { equipment: { chest: 'iron_chestplate', main_hand: 'iron_sword' }, inventory: { iron_chestplate: 1, iron_sword: 1, apple: 2 } }
  await inWorld({ agents: { ...pair({}), anne: agent([3.5, FLOOR, 0.5], start) } }, async world => {
    const { sally, anne } = world.bots
    const seen = () => Array.from({ length: 6 }, (_, part) => sally.players.anne.entity.equipment[part]?.name ?? null)
    await world.ticks(1)
    assert.deepEqual(seen(), ['iron_sword', null, null, null, 'iron_chestplate', null])
    assert.deepEqual(world.players.anne.possessions(), {
      inventory: start.inventory, equipment: start.equipment
    })
    await world.during(anne.equip(idOf(anne, 'apple'), 'hand'))
    await world.during(anne.unequip('torso'))
    await world.ticks(1)
    assert.deepEqual(seen(), ['apple', null, null, null, null, null])
    const last = world.frames.map(frame => frame.agents.anne).filter(Boolean).at(-1)
    assert.deepEqual(last.equipment, { main_hand: 'apple' })
  })
})

test('keys that drop and swap hands', async () => {
  await inWorld({ agents: pair({ apple: 5 }) }, async world => {
    const { sally } = world.bots
    const before = world.everything()
    await world.during(sally.equip(idOf(sally, 'apple'), 'hand'))
    sally._client.write('block_dig', { status: 4, location: new Vec3(0, 0, 0), face: 0 })
    sally._client.write('block_dig', { status: 6, location: new Vec3(0, 0, 0), face: 0 })
    await world.ticks(1)
    assert.deepEqual(world.players.sally.possessions(), { inventory: { apple: 4 }, equipment: { off_hand: 'apple' } })
    assert.equal(sally.inventory.slots[45].count, 4)
    assert.deepEqual(world.everything(), before)
  })
})
