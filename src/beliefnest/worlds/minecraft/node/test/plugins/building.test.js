'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR, Vec3 } = require('./harness')

const idOf = (bot, name) => bot.registry.itemsByName[name].id
const sally = (inventory, more = {}) => ({ sally: agent([0.5, FLOOR, 0.5], { inventory, ...more }) })

async function hold (world, name) {
  const { bots } = world
  await world.during(bots.sally.equip(idOf(bots.sally, name), 'hand'))
}

async function place (world, name, on, face) {
  const bot = world.bots.sally
  await hold(world, name)
  await world.during(bot.placeBlock(bot.blockAt(new Vec3(...on)), new Vec3(...face)))
}

test('mining takes the time of the tool, drops what the tool can harvest, and is reported', async () => {
  await inWorld({ agents: sally({ wooden_pickaxe: 1 }), blocks: [[2, FLOOR, 0, 'stone'], [2, FLOOR, 1, 'stone']] }, async world => {
    const bot = world.bots.sally
    await world.during(bot.equip(bot.inventory.items()[0], 'hand'))
    await world.during(bot.dig(bot.blockAt(new Vec3(2, FLOOR, 0))))
    await world.ticks(1)
    assert.equal(world.block(2, FLOOR, 0).name, 'air')
    assert.deepEqual(world.events(), [
      { kind: 'mine_block', actor: 'sally', detail: { position: [2, FLOOR, 0], block: 'stone' } }
    ])
    await world.during(bot.unequip('hand'))
    await world.during(bot.dig(bot.blockAt(new Vec3(2, FLOOR, 1))))
    await world.ticks(1)
    assert.deepEqual(world.everything(), { wooden_pickaxe: 1, cobblestone: 1 })
  })
})

test('a client that does not wait is told that the block is still there', async () => {
  await inWorld({ blocks: [[2, FLOOR, 0, 'stone']] }, async world => {
    const bot = world.bots.sally
    const location = new Vec3(2, FLOOR, 0)
    bot._client.write('block_dig', { status: 0, location, face: 1 })
    bot._client.write('block_dig', { status: 2, location, face: 1 })
    bot._updateBlockState(location, 0)
    await world.ticks(2)
    assert.equal(world.block(2, FLOOR, 0).name, 'stone')
    assert.equal(bot.blockAt(location).name, 'stone')
  })
})

test('what a client sent at two times and comes at one is mined when the time is over', async () => {
  const location = new Vec3(2, FLOOR, 0)
  const dig = (bot, status) => bot._client.write('block_dig', { status, location, face: 1 })
  await inWorld({ blocks: [[2, FLOOR, 0, 'dirt']] }, async world => {
    const { sally } = world.bots
    for (const status of [0, 2]) dig(sally, status)
    await world.ticks(1)
    assert.equal(sally.blockAt(location).name, 'dirt')
    // A repeated request, or one for another block, does not begin digging anew.
    for (const status of [1, 0, 2]) dig(sally, status)
    await world.ticks(sally.digTime(sally.blockAt(location)) / 50)
    assert.equal(world.block(2, FLOOR, 0).name, 'air')
    assert.deepEqual(world.events().map(({ kind }) => kind), ['mine_block'])
  })
  await inWorld({ blocks: [[2, FLOOR, 0, 'dirt']] }, async world => {
    for (const status of [0, 2]) dig(world.bots.sally, status)
    await world.ticks(1)
    world.serv.blocks.set(world.at(2, FLOOR, 0), world.serv.blocks.state('glass'))
    await world.ticks(50)
    assert.equal(world.block(2, FLOOR, 0).name, 'glass')
  })
})

const drops = [
  ['grass_block', 'dirt', 1], ['oak_log', 'oak_log', 1], ['oak_slab', 'oak_slab', 1], ['bookshelf', 'book', 3],
  ['glass', null, 0], ['clay', 'clay_ball', 4]
]
for (const [name, item, count] of drops) {
  test(`${name} drops ${count} ${item}`, async () => {
    await inWorld({ blocks: [[2, FLOOR, 0, name]] }, async world => {
      world.serv.mine(world.players.sally, world.at(2, FLOOR, 0))
      assert.deepEqual(world.everything(), item ? { [item]: count } : {})
    })
  })
}

test('placing uses one item up and is reported', async () => {
  await inWorld({ agents: sally({ stone: 2 }) }, async world => {
    await place(world, 'stone', [2, FLOOR - 1, 0], [0, 1, 0])
    await world.ticks(1)
    assert.deepEqual([world.block(2, FLOOR, 0).name, world.has('sally')], ['stone', { stone: 1 }])
    assert.deepEqual(world.events(), [
      { kind: 'place_block', actor: 'sally', detail: { position: [2, FLOOR, 0], block: 'stone' } }
    ])
  })
})

test('nothing is placed into somebody', async () => {
  await inWorld({ agents: { ...sally({ stone: 2 }), anne: agent([2.5, FLOOR, 0.5]) } }, async world => {
    await assert.rejects(place(world, 'stone', [2, FLOOR - 1, 0], [0, 1, 0]), /refused to place stone/)
    assert.deepEqual(world.has('sally'), { stone: 2 })
  })
})

test('blocks stand as the game puts them', async () => {
  const items = {
    oak_log: 2, oak_slab: 3, oak_stairs: 1, lever: 2, torch: 2, chest: 2, oak_door: 1, furnace: 1, ladder: 1, red_bed: 1
  }
  const wall = [0, 1].flatMap(up => [2, 3, 4].map(x => [x, FLOOR + up, -3, 'stone']))
  await inWorld({ agents: sally(items, { position: [3.5, FLOOR, 0.5] }), blocks: wall }, async world => {
    const at = (...place) => {
      const { name, properties } = world.block(...place)
      return { name, ...properties }
    }
    await place(world, 'oak_log', [2, FLOOR, -3], [0, 0, 1])
    assert.equal(at(2, FLOOR, -2).axis, 'z')
    await place(world, 'lever', [3, FLOOR, -3], [0, 0, 1])
    assert.deepEqual([at(3, FLOOR, -2).face, at(3, FLOOR, -2).facing], ['wall', 'south'])
    await place(world, 'torch', [4, FLOOR, -3], [0, 0, 1])
    assert.deepEqual([at(4, FLOOR, -2).name, at(4, FLOOR, -2).facing], ['wall_torch', 'south'])
    await place(world, 'ladder', [4, FLOOR + 1, -3], [0, 0, 1])
    assert.equal(at(4, FLOOR + 1, -2).facing, 'south')
    await place(world, 'oak_slab', [6, FLOOR - 1, 0], [0, 1, 0])
    assert.equal(at(6, FLOOR, 0).type, 'bottom')
    await place(world, 'oak_slab', [6, FLOOR, 0], [0, 1, 0]).catch(() => {})
    assert.equal(at(6, FLOOR, 0).type, 'double')
    await place(world, 'chest', [3, FLOOR - 1, 3], [0, 1, 0])
    assert.deepEqual([at(3, FLOOR, 3).facing, at(3, FLOOR, 3).type], ['north', 'single'])
    await place(world, 'chest', [4, FLOOR - 1, 3], [0, 1, 0])
    assert.deepEqual([at(3, FLOOR, 3).type, at(4, FLOOR, 3).type].sort(), ['left', 'right'])
    await place(world, 'furnace', [1, FLOOR - 1, 0], [0, 1, 0])
    assert.equal(at(1, FLOOR, 0).facing, 'east')
    await place(world, 'oak_door', [6, FLOOR - 1, 2], [0, 1, 0])
    assert.deepEqual([at(6, FLOOR, 2).half, at(6, FLOOR + 1, 2).half], ['lower', 'upper'])
    await place(world, 'red_bed', [1, FLOOR - 1, 2], [0, 1, 0])
    const foot = at(1, FLOOR, 2)
    assert.equal(foot.part, 'foot')
    const head = { west: [0, FLOOR, 2], south: [1, FLOOR, 3], north: [1, FLOOR, 1], east: [2, FLOOR, 2] }[foot.facing]
    assert.equal(at(...head).part, 'head')
  })
})

test('sand falls when what holds it is gone', async () => {
  await inWorld({ blocks: [[2, FLOOR, 0, 'dirt'], [2, FLOOR + 1, 0, 'sand'], [2, FLOOR + 2, 0, 'gravel']] }, async world => {
    world.serv.mine(world.players.sally, world.at(2, FLOOR, 0))
    await world.ticks(20)
    assert.deepEqual([0, 1, 2].map(up => world.block(2, FLOOR + up, 0).name), ['sand', 'gravel', 'air'])
  })
})

test('a lever comes off with its wall', async () => {
  await inWorld({ blocks: [[2, FLOOR, 0, 'stone'], [2, FLOOR, 1, 'lever', { face: 'wall', facing: 'south' }]] }, async world => {
    world.serv.mine(world.players.sally, world.at(2, FLOOR, 0))
    assert.equal(world.block(2, FLOOR, 1).name, 'air')
    assert.deepEqual(world.everything(), { lever: 1 })
  })
})

test('a fall of more than three blocks hurts, and never kills', async () => {
  const box = [[-11, -52, -11], [11, -30, 11]]
  await inWorld({ box, agents: { sally: agent([0.5, FLOOR + 8, 0.5], { on_ground: false }), anne: agent([4.5, FLOOR + 3, 0.5], { on_ground: false }) } }, async world => {
    await world.until(() => world.players.sally.onGround && world.players.anne.onGround)
    await world.ticks(2)
    assert.deepEqual([world.players.sally.health, world.players.anne.health], [15, 20])
    assert.equal(world.bots.sally.health, 15)
  })
})

test('eating takes its time, uses the food up and fills', async () => {
  await inWorld({ agents: sally({ bread: 2 }, { food: 10 }) }, async world => {
    const bot = world.bots.sally
    await hold(world, 'bread')
    const start = world.region.tick
    await world.during(bot.consume())
    assert.ok(world.region.tick - start >= 32)
    assert.deepEqual([world.players.sally.food, world.has('sally')], [15, { bread: 1 }])
    await world.ticks(1)
    assert.equal(bot.food, 15)
  })
})
