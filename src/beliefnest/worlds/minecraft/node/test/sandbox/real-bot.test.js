'use strict'
/** The allow-list with real Mineflayer bots in the embedded world. */
const assert = require('node:assert/strict')
const { after, before, describe, it } = require('node:test')
const { agent, floor, Node, region } = require('../harness')
const { kinds } = require('../../src/sandbox/policy/kinds')

const CHEST = 2955
const CHECK = 'const check = (what, found, wanted) => { if (found !== wanted) throw new Error(`${what}: ${found}, not ${wanted}`) };'

describe('a program with a real bot', () => {
  let node
  let count = 0
  before(async () => {
    node = new Node()
    await node.hello()
  })
  after(() => node.close())

  /** Run sally's program in a new region and return its result. */
  async function run (code, more = {}) {
    const name = `real-${count++}`
    const agents = {
      sally: agent([0.5, -51, 0.5], { inventory: { diamond: 3, dirt: 5, iron_pickaxe: 1 } }),
      anne: agent([-4.5, -51, 3.5])
    }
    const blocks = floor([[3, -51, 0, CHEST], [0, -51, 3, 1]])
    await node.request('create_region', region(name, { agents, blocks, containers: [[3, -51, 0, { emerald: 2 }]] }))
    const { results } = await node.request('run', { region: name, programs: { sally: CHECK + code, ...more }, timeout_ticks: 400 })
    await node.request('destroy_region', { region: name })
    return results.sally
  }

  it('can read every property that it may, of every kind of object', async () => {
    const names = Object.fromEntries(Object.entries(kinds).map(([kind, { get }]) => [kind, Object.keys(get)]))
    const { ok, error } = await run(`
      const names = ${JSON.stringify(names)}
      const chest = await bot.openContainer(bot.blockAt(new Vec3(3, -51, 0)))
      check('title', chest.title, 'Chest')
      const recipe = bot.recipesAll(mcData.itemsByName.stick.id, null, null)[0]
      const objects = { bot: [bot], entity: [bot.entity, bot.players.anne.entity], window: [chest, bot.inventory], recipe: [recipe], pathfinder: [bot.pathfinder] }
      check('kinds', Object.keys(objects).sort().join(), Object.keys(names).sort().join())
      const faults = []
      for (const [kind, several] of Object.entries(objects)) {
        for (const object of several) {
          for (const name of names[kind]) {
            try { JSON.stringify(object[name]) } catch (error) { faults.push(kind + '.' + name + ': ' + error.message) }
          }
        }
      }
      check('faults', faults.join('; '), '')`)
    assert.equal(ok, true, JSON.stringify(error))
  })

  it('reads the titles of windows however a server writes them', () => {
    const bot = { registry: require('prismarine-registry')('1.20.4') }
    const { title } = kinds.window.get
    const nbt = { type: 'compound', value: { text: { type: 'string', value: 'Large Chest' } } }
    const all = ['Inventory', '"Chest"', '{"translate":"container.chest"}', nbt, { type: 'string', value: 'Barrel' }, null, undefined]
    const titles = ['Inventory', 'Chest', 'Chest', 'Large Chest', 'Barrel', '', '']
    assert.deepEqual(all.map(each => title.toGuest({ bot }, each)), titles)
  })

  const WORKS = {
    'its own body': 'check("position", String(bot.entity.position), "(0.5, -51, 0.5)"); check("name", bot.username, "sally"); check("health", bot.health, 20); check("version", bot.version, "1.20.4")',
    'the others': 'const anne = bot.players.anne.entity; check("same", anne, bot.nearestEntity((e) => e.username === "anne")); check("distance", Math.round(anne.position.distanceTo(bot.entity.position)), 6)',
    'its inventory': 'check("items", bot.inventory.items().map((i) => `${i.name}:${i.count}`).sort().join(), "diamond:3,dirt:5,iron_pickaxe:1"); check("count", bot.inventory.count(mcData.itemsByName.dirt.id), 5)',
    'blocks': 'const b = bot.blockAt(new Vec3(3, -51, 0)); check("name", b.name, "chest"); check("facing", b.getProperties().facing, "north"); check("hardness", b.hardness, mcData.blocksByName.chest.hardness)',
    'a search by function': 'const b = bot.findBlock({ matching: (b) => b.name === "chest", maxDistance: 16 }); check("at", String(b.position), "(3, -51, 0)")',
    'a search by id': 'const found = bot.findBlocks({ matching: mcData.blocksByName.chest.id, maxDistance: 16, count: 10 }); check("found", found.length, 1)',
    'walking to a goal': 'await bot.pathfinder.goto(new goals.GoalNear(5, -51, 5, 1)); if (bot.entity.position.distanceTo(new Vec3(5.5, -51, 5.5)) > 2) throw new Error("not there")',
    'movements': 'const m = new Movements(bot); m.canDig = false; bot.pathfinder.setMovements(m); await bot.pathfinder.goto(new goals.GoalBlock(0, -51, 5)); check("stone", bot.blockAt(new Vec3(0, -51, 3)).name, "stone")',
    'following': 'bot.pathfinder.setGoal(new goals.GoalFollow(bot.players.anne.entity, 1), true); for (let i = 0; i < 100 && bot.entity.position.distanceTo(bot.players.anne.entity.position) > 2; i++) await bot.waitForTicks(1); if (bot.entity.position.distanceTo(bot.players.anne.entity.position) > 2) throw new Error("too far")',
    'control states': 'bot.look(0, 0, true); bot.setControlState("forward", true); check("state", bot.getControlState("forward"), true); await bot.waitForTicks(5); bot.clearControlStates(); if (bot.entity.position.z > 0.4) throw new Error("did not move")',
    'looking': 'await bot.lookAt(bot.entity.position.offset(5, 1.62, 0), true); check("yaw", bot.entity.yaw.toFixed(2), (-Math.PI / 2).toFixed(2))',
    'equipping': 'await bot.equip(bot.inventory.items().find((i) => i.name === "iron_pickaxe"), "hand"); check("held", bot.heldItem.name, "iron_pickaxe")',
    'digging': 'await bot.equip(mcData.itemsByName.iron_pickaxe.id, "hand"); await bot.dig(bot.blockAt(new Vec3(0, -51, 3))); check("gone", bot.blockAt(new Vec3(0, -51, 3)).name, "air")',
    'placing': 'await bot.equip(mcData.itemsByName.dirt.id, "hand"); await bot.placeBlock(bot.blockAt(new Vec3(2, -52, 0)), new Vec3(0, 1, 0)); check("placed", bot.blockAt(new Vec3(2, -51, 0)).name, "dirt")',
    'a chest': 'const chest = await bot.openContainer(bot.blockAt(new Vec3(3, -51, 0))); check("inside", chest.containerItems().map((i) => i.name + i.count).join(), "emerald2"); await chest.withdraw(mcData.itemsByName.emerald.id, null, 1); await chest.deposit(mcData.itemsByName.diamond.id, null, 2); check("after", chest.containerItems().map((i) => i.name + i.count).sort().join(), "diamond2,emerald1"); chest.close(); check("mine", bot.inventory.count(mcData.itemsByName.emerald.id), 1)',
    'tossing': 'await bot.toss(mcData.itemsByName.dirt.id, null, 2); check("left", bot.inventory.count(mcData.itemsByName.dirt.id), 3)',
    'recipes': 'check("none", bot.recipesFor(mcData.itemsByName.diamond_sword.id, null, 1, null).length, 0); check("all", bot.recipesAll(mcData.itemsByName.stick.id, null, null).length > 0, true)',
    'skills': 'await goToPosition(bot, new Vec3(3, -51, 2)); if (bot.entity.position.distanceTo(new Vec3(3, -51, 2)) > 3) throw new Error("not there")',
    'virtual time': 'const start = Date.now(); await new Promise((resolve) => setTimeout(resolve, 1000)); check("ms", Date.now() - start, 1000)'
  }
  for (const [what, code] of Object.entries(WORKS)) {
    it(`can use ${what}`, async () => {
      const { ok, error } = await run(code)
      assert.equal(ok, true, JSON.stringify(error))
    })
  }

  const REFUSED = {
    'a command in a second line of speech': ['await say(bot, "hello\\n/op sally")', /one line/],
    'a command by chat': ['bot.chat("/op sally")', /is a command/],
    'a thought of 10 MB': ['await think(bot, "x".repeat(1e7))', /characters/],
    'a place outside the world': ['await goToPosition(bot, new Vec3(1e9, 0, 0))', /outside the world/],
    'the bot as a place': ['await goToPosition(bot, bot)', /an object of the game/],
    'a goal in place of a position': ['await goToPosition(bot, { a: new goals.GoalLookAtBlock(new Vec3(5, 1, 5), bot.world) })', /it is an object$/],
    'movements without end': ['for (;;) await lookAt(bot, Array.from({ length: 1000 }, () => new Movements(bot))).catch(() => {})', /fuel/],
    'an entity in place of a position': ['await goToPosition(bot, { a: bot.players.anne.entity })', /it is an object$/],
    'a function in place of a position': ['await goToPosition(bot, () => 1)', /it is a function$/],
    'a long text in place of a position': ['await goToPosition(bot, "x".repeat(90000))', /it is "x{196} \.\.\."$/],
    'another bot': ['await goToPosition(bot.players.anne.entity, new Vec3(0, -51, 0))', /must be bot/],
    'an endless condition': ['await waitUntil(bot, () => { for (;;) {} })', /fuel exhausted/],
    'a condition that waits for ever': ['await waitUntil(bot, () => new Promise(() => {}))', /did not end within 400 ticks/],
    'an endless search': ['for (;;) bot.findBlocks({ matching: 1, maxDistance: 128, count: 1000 })', /fuel exhausted/],
    'an endless listener': ['bot.on("physicsTick", () => { for (;;) {} }); await bot.waitForTicks(5)', /fuel exhausted/],
    'a lying callback': ['await exploreUntil(bot, new Vec3(1, 0, 0), 5, () => ({ then: 1, get x() { throw 7 } }))', /7/]
  }
  for (const [what, [code, message]] of Object.entries(REFUSED)) {
    it(`is refused ${what}`, async () => {
      const { ok, error } = await run(code)
      assert.equal(ok, false)
      assert.match(error.message, message)
    })
  }

  it('hears chat', async () => {
    const { error } = await run(`
      const heard = await new Promise((resolve) => bot.once('chat', (name, text) => resolve(name + ': ' + text)))
      check('heard', heard, 'anne: hello')`, { anne: 'await bot.waitForTicks(2); bot.chat("hello")' })
    assert.equal(error, null)
  })

  it('says where a skill failed', async () => {
    const { error } = await run('\nawait bot.waitForTicks(1)\n  await goToPosition(bot, new Vec3(500, -51, 0))')
    assert.deepEqual([error.line, error.column, error.skill, error.kind], [3, 9, 'goToPosition', 'skill'])
  })

  it('is ended by the timeout, and the next one runs', async () => {
    await node.request('create_region', region('endless'))
    const run = (code) => node.request('run', { region: 'endless', programs: { sally: code }, timeout_ticks: 10 })
    const first = await run('for (;;) await bot.waitForTicks(1)')
    assert.deepEqual([first.results.sally.error.kind, first.results.sally.ticks], ['timeout', 10])
    const second = await run('await bot.waitForTicks(3)')
    assert.deepEqual([second.results.sally.ok, second.results.sally.ticks], [true, 3])
  })
})
