'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./harness')

const PLACE = [5, FLOOR, 3]
const SPOT = new Vec3(...PLACE)
const setting = (inventory, blocks = [], more = {}) => ({ agents: { sally: agent([0.5, FLOOR, 0.5], { inventory }) }, blocks, ...more })
const sorted = counts => Object.fromEntries(Object.entries(counts).sort())

async function run (world, name, ...args) {
  await world.during(world.skills.sally[name](world.bots.sally, ...args))
  await world.ticks(1)
}
/** Return the counts of items in events, by name. */
function made (events) {
  const total = {}
  for (const [name, count] of events.flatMap(({ detail }) => Object.entries(detail.items))) total[name] = (total[name] ?? 0) + count
  return total
}

const message = async (world, name, ...args) => {
  const error = await failure(world, world.skills.sally[name](world.bots.sally, ...args))
  assert.equal(error.skill, name)
  return error.message
}

test('mineBlock goes there, takes the right tool and brings the drop home', async () => {
  await withSkills(setting({ dirt: 1, wooden_pickaxe: 1, stone_pickaxe: 1 }, [[...PLACE, 'stone']]), async world => {
    await run(world, 'mineBlock', SPOT, 'stone')
    assert.deepEqual(sorted(await world.has('sally')), { cobblestone: 1, dirt: 1, stone_pickaxe: 1, wooden_pickaxe: 1 })
    assert.equal((await world.player('sally')).equipment.main_hand, 'stone_pickaxe')
    assert.deepEqual((await world.events('mine_block')).map(({ detail }) => detail), [{ position: PLACE, block: 'stone' }])
  })
})

test('mineBlock says what is there, and which tool it takes', async () => {
  await withSkills(setting({ dirt: 1 }, [[...PLACE, 'stone'], [7, FLOOR, 7, 'bedrock']]), async world => {
    assert.match(await message(world, 'mineBlock', SPOT, 'dirt'), /no dirt at \(5, -51, 3\), but stone/)
    assert.match(await message(world, 'mineBlock', SPOT, 'stone'), /needs one of these tools: wooden_pickaxe, /)
    assert.match(await message(world, 'mineBlock', new Vec3(7, FLOOR, 7), 'bedrock'), /cannot be mined/)
    assert.match(await message(world, 'mineBlock', SPOT, 'stonee'), /name of a block.*similar names: .*stone/)
    assert.equal((await world.block(...PLACE)).name, 'stone')
  })
})

test('mineBlock with a full inventory says what was left lying', async () => {
  await withSkills(setting({ stick: 36 * 64 }, [[...PLACE, 'dirt']]), async world => {
    assert.match(await message(world, 'mineBlock', SPOT, 'dirt'), /dirt was left lying .* no room/)
    assert.deepEqual(await world.everything(), { stick: 36 * 64, dirt: 1 })
  })
})

test('placeItem places, also beside a chest without opening it', async () => {
  await withSkills(setting({ dirt: 2, torch: 1 }, [[6, FLOOR, 3, 'chest']]), async world => {
    await run(world, 'placeItem', 'dirt', SPOT)
    await run(world, 'placeItem', 'torch', new Vec3(0, FLOOR, 0))
    await run(world, 'placeItem', 'dirt', new Vec3(6, FLOOR + 1, 3))
    assert.deepEqual([(await world.block(...PLACE)).name, (await world.block(0, FLOOR, 0)).name, (await world.block(6, FLOOR + 1, 3)).name], ['dirt', 'torch', 'dirt'])
    assert.deepEqual(await world.has('sally'), {})
    assert.deepEqual((await world.events()).map(({ kind }) => kind), ['place_block', 'place_block', 'place_block'])
  })
})

test('placeItem says why it cannot', async () => {
  await withSkills(setting({ dirt: 2 }, [[...PLACE, 'stone']]), async world => {
    assert.match(await message(world, 'placeItem', 'stone', new Vec3(3, FLOOR, 3)), /holds no stone; it holds: 2 dirt/)
    assert.match(await message(world, 'placeItem', 'dirt', SPOT), /not free: stone is there/)
    assert.match(await message(world, 'placeItem', 'dirt', new Vec3(2, FLOOR + 2, 2)), /no solid block beside/)
  })
})

test('givePlacedItemBack brings a placed block back', async () => {
  await withSkills(setting({ crafting_table: 1 }), async world => {
    await run(world, 'placeItem', 'crafting_table', SPOT)
    await run(world, 'givePlacedItemBack', 'crafting_table', SPOT)
    assert.deepEqual(await world.has('sally'), { crafting_table: 1 })
    assert.match(await message(world, 'givePlacedItemBack', 'crafting_table', SPOT), /no crafting_table at/)
  })
})

test('craftItem makes things by hand and at a table', async () => {
  await withSkills(setting({ oak_log: 4 }, [[...PLACE, 'crafting_table']]), async world => {
    await run(world, 'craftItem', 'oak_planks', null, 9)
    assert.deepEqual(await world.has('sally'), { oak_log: 1, oak_planks: 12 })
    await run(world, 'craftItem', 'chest', SPOT, 1)
    assert.deepEqual(sorted(await world.has('sally')), { chest: 1, oak_log: 1, oak_planks: 4 })
    assert.deepEqual(made(await world.events('craft_item')), { oak_planks: 12, chest: 1 })
    assert.deepEqual(world.emitted, [])
  })
})

test('craftItem names what is missing', async () => {
  await withSkills(setting({ oak_planks: 8 }), async world => {
    assert.match(await message(world, 'craftItem', 'chest', null, 2), /2 chest cannot be made, missing: 8 oak_planks/)
    assert.match(await message(world, 'craftItem', 'chest', null, 1), /needs a crafting table/)
    assert.match(await message(world, 'craftItem', 'chest', SPOT, 1), /no crafting table at .* but air/)
    assert.match(await message(world, 'craftItem', 'diamond_ore', null, 1), /no recipe for diamond_ore/)
    assert.deepEqual(await world.has('sally'), { oak_planks: 8 })
  })
})

test('smeltItem feeds the fuel that is needed and takes everything out', async () => {
  await withSkills(setting({ raw_iron: 3, oak_planks: 5 }, [[...PLACE, 'furnace']]), async world => {
    await run(world, 'smeltItem', 'raw_iron', 'oak_planks', SPOT, 3)
    assert.deepEqual(sorted(await world.has('sally')), { iron_ingot: 3, oak_planks: 3 })
    assert.deepEqual(await world.container(...PLACE), {})
    assert.deepEqual(made(await world.events('smelt_item')), { iron_ingot: 3 })
    assert.deepEqual(world.emitted, [])
  })
})

test('smeltItem says what it lacks, and gives back what it put in', async () => {
  await withSkills(setting({ raw_iron: 3, oak_planks: 1, dirt: 1, coal: 1 }, [[...PLACE, 'furnace']]), async world => {
    const before = sorted(await world.everything())
    assert.match(await message(world, 'smeltItem', 'raw_iron', 'coal', SPOT, 4), /4 raw_iron asked for, the inventory holds 3/)
    assert.match(await message(world, 'smeltItem', 'raw_iron', 'dirt', SPOT, 1), /dirt does not burn/)
    assert.match(await message(world, 'smeltItem', 'dirt', 'coal', SPOT, 1), /dirt cannot be smelted in a furnace/)
    assert.deepEqual(sorted(await world.everything()), before)
    assert.deepEqual(sorted(await world.has('sally')), before)
    assert.match(await message(world, 'smeltItem', 'raw_iron', 'oak_planks', SPOT, 3), /1 of 3 raw_iron were smelted, then the oak_planks ran out/)
    assert.deepEqual(sorted(await world.has('sally')), { coal: 1, dirt: 1, iron_ingot: 1, raw_iron: 2 })
    assert.match(await message(world, 'smeltItem', 'raw_iron', 'coal', new Vec3(1, FLOOR, 1), 1), /no furnace at/)
  })
})

test('equip and eat', async () => {
  await withSkills({ agents: { sally: agent([0.5, FLOOR, 0.5], { inventory: { iron_helmet: 1, bread: 2, dirt: 1 }, food: 15 }) } }, async world => {
    await run(world, 'equip', 'iron_helmet', 'head')
    assert.equal((await world.player('sally')).equipment.head, 'iron_helmet')
    assert.match(await message(world, 'equip', 'dirt', 'feet'), /does not go there/)
    assert.equal(world.bots.sally.inventory.selectedItem, null)
    assert.match(await message(world, 'equip', 'dirt', 'nose'), /one of hand, off-hand/)
    assert.match(await message(world, 'equip', 'stone'), /holds no stone/)
    await run(world, 'eat', 'bread')
    assert.equal((await world.player('sally')).food, 20)
    assert.match(await message(world, 'eat', 'bread'), /not hungry/)
    assert.match(await message(world, 'eat', 'dirt'), /no food/)
    assert.deepEqual(sorted(await world.has('sally')), { bread: 1, dirt: 1, iron_helmet: 1 })
  })
})

test('sleep goes to bed and gets up', async () => {
  const bed = [[5, FLOOR, 3, 'red_bed', { part: 'foot', facing: 'east' }], [6, FLOOR, 3, 'red_bed', { part: 'head', facing: 'east' }]]
  await withSkills(setting({}, bed), async world => {
    await run(world, 'sleep', SPOT, 40)
    const seen = (await world.events('block_update')).map(({ detail }) => /occupied=(true|false)/.exec(detail.block)[1])
    assert.deepEqual(seen, ['true', 'true', 'false', 'false'])
    assert.match(await message(world, 'sleep', new Vec3(1, FLOOR, 1)), /no bed at/)
  })
})
