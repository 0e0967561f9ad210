'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./harness')

const PLACE = [6, FLOOR, 3]
const CHEST = new Vec3(...PLACE)
const setting = (inventory = {}, more = []) => ({
  agents: { sally: agent([0.5, FLOOR, 0.5], { inventory }) },
  blocks: [[...PLACE, 'chest'], ...more],
  containers: [[...PLACE, { diamond: 2, dirt: 70 }]]
})

test('getItemFromChest goes there, takes the items, and leaves the rest', async () => {
  await withSkills(setting(), async world => {
    const { bots: { sally }, skills } = world
    const before = await world.everything()
    await world.during(skills.sally.getItemFromChest(sally, CHEST, { diamond: 1, dirt: 65 }))
    await world.ticks(1)
    assert.deepEqual(await world.has('sally'), { diamond: 1, dirt: 65 })
    assert.deepEqual(await world.container(...PLACE), { diamond: 1, dirt: 5 })
    assert.deepEqual(await world.everything(), before)
    const [opened, ...taken] = await world.events()
    assert.equal(opened.kind, 'open_container')
    // In real time a tick may end between two clicks.
    if (world.isVirtual) assert.equal(taken.length, 1)
    assert.ok(taken.every(({ kind }) => kind === 'get_item_from_chest'))
    const sum = name => taken.reduce((total, { detail }) => total + (detail.items[name] ?? 0), 0)
    assert.deepEqual([sum('diamond'), sum('dirt')], [1, 65])
  })
})

test('getItemFromChest takes what is there and names what is missing', async () => {
  await withSkills(setting(), async world => {
    const { bots: { sally }, skills } = world
    const before = await world.everything()
    const error = await failure(world, skills.sally.getItemFromChest(sally, CHEST, { diamond: 3, apple: 1 }))
    assert.equal(error.skill, 'getItemFromChest')
    assert.match(error.message, /3 diamond asked for from the chest at \(6, -51, 3\), it holds 2; 2 taken; 1 apple .* it holds 0; 0 taken/)
    await world.ticks(1)
    assert.deepEqual(await world.has('sally'), { diamond: 2 })
    assert.equal(sally.currentWindow, null)
    assert.deepEqual(await world.everything(), before)
  })
})

test('getItemFromChest stops at a full inventory', async () => {
  await withSkills(setting({ stone: 36 * 64 - 1 }), async world => {
    const { bots: { sally }, skills } = world
    const before = await world.everything()
    const error = await failure(world, skills.sally.getItemFromChest(sally, CHEST, { diamond: 1 }))
    assert.match(error.message, /room for 0 in the inventory/)
    await world.ticks(1)
    assert.deepEqual(await world.everything(), before)
  })
})

test('depositItemIntoChest puts the items in', async () => {
  await withSkills(setting({ apple: 5 }), async world => {
    const { bots: { sally }, skills } = world
    const before = await world.everything()
    await world.during(skills.sally.depositItemIntoChest(sally, CHEST, { apple: 4 }))
    await world.ticks(1)
    assert.deepEqual(await world.has('sally'), { apple: 1 })
    assert.deepEqual(await world.container(...PLACE), { diamond: 2, dirt: 70, apple: 4 })
    assert.deepEqual(await world.everything(), before)
    assert.deepEqual((await world.events('deposit_item_into_chest')).map(({ actor, detail }) => [actor, detail]), [
      ['sally', { position: PLACE, items: { apple: 4 } }]
    ])
  })
})

test('depositItemIntoChest says how many there were', async () => {
  await withSkills(setting({ apple: 5 }), async world => {
    const { bots: { sally }, skills } = world
    const error = await failure(world, skills.sally.depositItemIntoChest(sally, CHEST, { apple: 6 }))
    assert.equal(error.skill, 'depositItemIntoChest')
    assert.match(error.message, /6 apple .* the inventory holds 5; 5 put in/)
  })
})

test('a place without a chest, and a chest under a stone, are named', async () => {
  await withSkills(setting({}, [[6, FLOOR + 1, 3, 'stone']]), async world => {
    const { bots: { sally }, skills } = world
    const nothing = await failure(world, skills.sally.getItemFromChest(sally, new Vec3(1, FLOOR, 1), { dirt: 1 }))
    assert.match(nothing.message, /no chest at \(1, -51, 1\), but air/)
    const covered = await failure(world, skills.sally.getItemFromChest(sally, CHEST, { dirt: 1 }))
    assert.match(covered.message, /stone lies on its lid/)
  })
})

test('arguments that make no sense are named', async () => {
  await withSkills(setting(), async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const message = async promise => (await failure(world, promise)).message
    assert.match(await message(own.getItemFromChest(sally, { x: NaN, y: 0, z: 0 }, { dirt: 1 })), /finite/)
    assert.match(await message(own.getItemFromChest(sally, CHEST, { diamnd: 1 })), /name of an item/)
    assert.match(await message(own.getItemFromChest(sally, CHEST, { dirt: 0.5 })), /whole number/)
    for (const name of ['constructor', '__proto__', 'toString']) {
      assert.match(await message(own.mineBlock(sally, CHEST, name)), /name of a block/)
      assert.match(await message(own.equip(sally, name)), /name of an item/)
      assert.match(await message(own.emote(name, 'wave')), /name of an agent/)
    }
    assert.match(await message(own.getItemFromChest(sally, CHEST, { constructor: 1 })), /name of an item/)
    assert.match(await message(own.goToPosition(sally, { x: 1e300, y: 0, z: 0 })), /no way to it/)
    assert.match(await message(own.getItemFromChest(sally, CHEST)), /how many of which items/)
    assert.match(await message(own.getItemFromChest(CHEST, { dirt: 1 })), /must be bot/)
  })
})

test('of two who reach into a chest at the same time each has what it was told it has', async () => {
  const agents = { sally: agent([4.5, FLOOR, 3.5]), anne: agent([6.5, FLOOR, 1.5]) }
  await withSkills({ ...setting(), agents, containers: [[...PLACE, { diamond: 1 }]] }, async world => {
    const { bots, skills } = world
    const outcomes = await world.during(Promise.allSettled(Object.keys(agents).map(name =>
      skills[name].getItemFromChest(bots[name], CHEST, { diamond: 1 }))))
    const itemsLeft = outcomes.map(({ status }) => status === 'fulfilled' ? { diamond: 1 } : {})
    assert.deepEqual([await world.has('sally'), await world.has('anne')], itemsLeft)
    assert.deepEqual(await world.everything(), { diamond: 1 })
  })
})
