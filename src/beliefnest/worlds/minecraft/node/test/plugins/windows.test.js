'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR, Vec3 } = require('./harness')

const LEFT = [2, FLOOR, 0]
const RIGHT = [3, FLOOR, 0]
const sallyAndAnne = (inventory = {}) => ({
  sally: agent([1.5, FLOOR, 2.5], { inventory }), anne: agent([3.5, FLOOR, 2.5])
})
/** Of a double chest that faces north, the half of type "left" has the other half to its east. */
const double = [[...LEFT, 'chest', { type: 'left' }], [...RIGHT, 'chest', { type: 'right' }]]
const idOf = (bot, name) => bot.registry.itemsByName[name].id
const open = (world, name, place) => world.during(world.bots[name].openContainer(world.bots[name].blockAt(new Vec3(...place))))
const shown = window => window.slots.map(item => item && [item.name, item.count])

test('a double chest is one container at its right half, whichever half is used', async () => {
  await inWorld({
    agents: sallyAndAnne(), blocks: double, containers: [[...RIGHT, { apple: 27 * 64, diamond: 1 }]]
  }, async world => {
    const { sally } = world.bots
    const window = await open(world, 'sally', LEFT)
    assert.equal(window.inventoryStart, 54)
    assert.deepEqual([window.slots[0].name, window.slots[27].name], ['apple', 'diamond'])
    await world.during(window.withdraw(idOf(sally, 'apple'), null, 1))
    await world.during(window.withdraw(idOf(sally, 'diamond'), null, 1))
    await world.during(window.close())
    await world.ticks(1)
    assert.deepEqual([world.container(...LEFT), world.container(...RIGHT)], [null, { apple: 27 * 64 - 1 }])
    assert.deepEqual(world.events().map(({ kind, detail }) => [kind, detail.position]), [
      ['open_container', RIGHT], ['get_item_from_chest', RIGHT], ['get_item_from_chest', RIGHT]
    ])
    assert.deepEqual(world.frames.flatMap(frame => frame.containers).at(-1), [...RIGHT, { apple: 27 * 64 - 1 }])
  })
})

test('two who look into one chest see what the other does', async () => {
  await inWorld({
    agents: sallyAndAnne({ apple: 3 }), blocks: [[...LEFT, 'chest']], containers: [[...LEFT, { diamond: 5 }]]
  }, async world => {
    const { sally, anne } = world.bots
    const before = world.everything()
    const [hers, annes] = [await open(world, 'sally', LEFT), await open(world, 'anne', LEFT)]
    await world.during(hers.deposit(idOf(sally, 'apple'), null, 2))
    await world.until(() => annes.slots[1]?.count === 2)
    await world.during(annes.withdraw(idOf(anne, 'diamond'), null, 3))
    await world.until(() => hers.slots[0]?.count === 2)
    assert.deepEqual(shown(hers).slice(0, 27), shown(annes).slice(0, 27))
    await Promise.all([world.during(hers.close()), annes.close()])
    await world.ticks(1)
    assert.deepEqual(world.has('anne'), { diamond: 3 })
    assert.deepEqual(world.everything(), before)
  })
})

test('two who grab the same stack in the same tick get it once', async () => {
  await inWorld({
    agents: sallyAndAnne(), blocks: [[...LEFT, 'chest']], containers: [[...LEFT, { diamond: 1 }]]
  }, async world => {
    const [hers, annes] = [await open(world, 'sally', LEFT), await open(world, 'anne', LEFT)]
    const { sally, anne } = world.bots
    await world.during(Promise.all([sally.clickWindow(0, 0, 0), anne.clickWindow(0, 0, 0)]))
    await world.ticks(1)
    assert.deepEqual([hers.selectedItem?.name, annes.selectedItem], ['diamond', null])
    assert.deepEqual(world.everything(), { diamond: 1 })
  })
})

test('shift-click, number keys and dropping move items as in the game', async () => {
  await inWorld({
    agents: sallyAndAnne({ apple: 3 }), blocks: [[...LEFT, 'chest']], containers: [[...LEFT, { diamond: 5, dirt: 70 }]]
  }, async world => {
    const { sally } = world.bots
    const before = world.everything()
    const window = await open(world, 'sally', LEFT)
    await world.during(sally.clickWindow(0, 0, 1))
    await world.ticks(1)
    assert.equal(world.has('sally').diamond, 5)
    await world.during(sally.clickWindow(1, 4, 2))
    await world.ticks(1)
    assert.equal(sally.currentWindow.slots[window.inventoryStart + 27 + 4].count, 64)
    await world.during(sally.clickWindow(2, 1, 4))
    await world.ticks(1)
    assert.deepEqual(world.container(...LEFT), {})
    assert.deepEqual(world.everything(), before)
    assert.deepEqual(world.serv.itemEntities(() => true).map(({ item }) => [item.name, item.count]), [['dirt', 6]])
    assert.deepEqual(world.events('get_item_from_chest').map(({ detail }) => detail.items), [{ diamond: 5 }, { dirt: 64 }, { dirt: 6 }])
  })
})

test('what the cursor carries comes back when the window closes', async () => {
  await inWorld({
    agents: sallyAndAnne(), blocks: [[...LEFT, 'chest']], containers: [[...LEFT, { diamond: 5 }]]
  }, async world => {
    const { sally } = world.bots
    const window = await open(world, 'sally', LEFT)
    await world.during(sally.clickWindow(0, 1, 0))
    await world.ticks(1)
    assert.deepEqual([world.container(...LEFT), world.has('sally'), world.events('get_item_from_chest')], [{ diamond: 2 }, { diamond: 3 }, []])
    await world.during(window.close())
    await world.ticks(1)
    assert.deepEqual(world.has('sally'), { diamond: 3 })
    assert.deepEqual(sally.inventory.items().map(item => item.count), [3])
    assert.deepEqual(world.events('get_item_from_chest').map(({ detail }) => detail.items), [{ diamond: 3 }])
  })
})

test('sorting inside a chest is no transfer', async () => {
  await inWorld({
    agents: sallyAndAnne(), blocks: [[...LEFT, 'chest']], containers: [[...LEFT, { diamond: 5 }]]
  }, async world => {
    const { sally } = world.bots
    const window = await open(world, 'sally', LEFT)
    await world.during(sally.clickWindow(0, 0, 0))
    await world.during(sally.clickWindow(9, 0, 0))
    await world.during(window.close())
    await world.ticks(1)
    assert.deepEqual(world.events().map(({ kind }) => kind), ['open_container'])
  })
})

test('a chest under a stone stays shut, a barrel does not', async () => {
  await inWorld({
    agents: sallyAndAnne(),
    blocks: [[...LEFT, 'chest'], [2, FLOOR + 1, 0, 'stone'], [...RIGHT, 'barrel'], [3, FLOOR + 1, 0, 'stone']]
  }, async world => {
    const { sally } = world.bots
    await world.during(sally.activateBlock(sally.blockAt(new Vec3(...LEFT))))
    await world.ticks(1)
    assert.equal(sally.currentWindow, null)
    await open(world, 'sally', RIGHT)
    assert.equal(world.block(...RIGHT).properties.open, true)
  })
})

test('a chest that is too far away stays shut, and so does one for who sneaks with something in hand', async () => {
  await inWorld({ agents: sallyAndAnne({ dirt: 1 }), blocks: [[9, FLOOR, 0, 'chest'], [...LEFT, 'chest']] }, async world => {
    const { sally } = world.bots
    await assert.rejects(world.during(sally.activateBlock(sally.blockAt(new Vec3(9, FLOOR, 0)))), /chest at \(9, -51, 0\) .*: it is 8\.3 blocks away/)
    sally._client.write('block_place', { location: new Vec3(9, FLOOR, 0), direction: 1, hand: 0, cursorX: 0.5, cursorY: 0.5, cursorZ: 0.5, insideBlock: false, sequence: 0 })
    await world.ticks(1)
    assert.equal(sally.currentWindow, null)
    await world.during(sally.equip(idOf(sally, 'dirt'), 'hand'))
    sally.setControlState('sneak', true)
    await world.ticks(3)
    await world.during(sally.activateBlock(sally.blockAt(new Vec3(...LEFT)), new Vec3(0, 0, 1)))
    await world.ticks(1)
    assert.equal(sally.currentWindow, null)
    assert.equal(world.block(2, FLOOR, 1).name, 'dirt')
    sally.setControlState('sneak', false)
    await world.ticks(3)
    await open(world, 'sally', LEFT)
  })
})

test('breaking a chest spills it, and the other half becomes a single one', async () => {
  await inWorld({
    agents: sallyAndAnne(), blocks: double, containers: [[...RIGHT, { apple: 27 * 64, diamond: 70 }]]
  }, async world => {
    const { sally } = world.bots
    const before = world.everything()
    await world.during(sally.dig(sally.blockAt(new Vec3(...LEFT))))
    await world.ticks(1)
    assert.equal(world.block(...RIGHT).properties.type, 'single')
    assert.deepEqual(world.everything(), { ...before, chest: 1 })
    assert.equal(world.container(...LEFT), null)
    assert.deepEqual(world.container(...RIGHT), { apple: 27 * 64 })
    assert.deepEqual(world.frames.flatMap(frame => frame.containers), [[...RIGHT, { apple: 27 * 64 }]])
  })
})

test('any sequence of clicks conserves every item', async () => {
  await inWorld({
    agents: sallyAndAnne({ apple: 40, stone: 130, iron_helmet: 2, ender_pearl: 20 }), blocks: double,
    containers: [[...RIGHT, { diamond: 70, apple: 64, stone: 10, ender_pearl: 5 }]]
  }, async world => {
    const { sally, anne } = world.bots
    const before = world.everything()
    let state = 12345
    const random = n => {
      state = (state * 1103515245 + 12345) % 2147483648
      return Math.floor(state / 65536) % n
    }
    const windows = { sally: await open(world, 'sally', LEFT), anne: await open(world, 'anne', RIGHT) }
    for (let step = 0; step < 400; step++) {
      const bot = random(2) ? sally : anne
      if (random(12) === 0) bot._client.write('close_window', { windowId: windows[bot.username].id })
      const packet = { slot: random(92) - 1, mouseButton: random(9), mode: random(7) }
      if (packet.slot === -1) packet.slot = -999
      const windowId = world.players[bot.username].windows.current.id
      bot._client.write('window_click', {
        windowId, stateId: random(3), ...packet, changedSlots: [], cursorItem: { present: false }
      })
      if (random(10) === 0) bot.activateBlock(bot.blockAt(new Vec3(...LEFT)))
      if (random(4) === 0) await world.ticks(1)
      assert.deepEqual(sorted(world.everything()), sorted(before), JSON.stringify([step, bot.username, packet]))
    }
  })
})

const sorted = counts => Object.entries(counts).sort()
