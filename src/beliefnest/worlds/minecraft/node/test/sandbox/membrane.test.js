'use strict'
const assert = require('node:assert')
const { before, beforeEach, describe, it } = require('node:test')
const { Vec3 } = require('vec3')
const { goals } = require('mineflayer-pathfinder')
const { createSandbox } = require('../../src/sandbox')
const { fakeBot, fakeScope, FakeBlock } = require('./fake-world')

describe('the membrane', () => {
  let sandbox
  let bot
  let scope
  before(() => { sandbox = createSandbox({ fuel: 20_000_000 }) })
  beforeEach(() => {
    bot = fakeBot()
    scope = fakeScope(bot)
  })
  const run = (code, more) => sandbox.run({ code, bot, scope, ...more })

  /** Return the text that a program logged. */
  async function logged (code) {
    const { ok, error, log } = await run(code)
    assert.strictEqual(ok, true, error?.message)
    return log.map(({ text }) => text).join('\n')
  }

  it('runs an empty program', async () => {
    const { ok, error, lines, unfinished } = await run('')
    assert.deepStrictEqual({ ok, error, lines, unfinished }, { ok: true, error: null, lines: [], unfinished: [] })
  })

  it('hands positions over both ways as Vec3', async () => {
    assert.strictEqual(await logged(`
      const p = await goToPosition(bot, bot.entity.position.offset(1, 0, 0), 1)
      console.log(p instanceof Vec3, p, p.distanceTo(new Vec3(2.5, 3, 4.5)))`), 'true (2.5, 3, 3.5) 1')
    const [[, position, dist]] = bot.calls
    assert.ok(position instanceof Vec3)
    assert.deepStrictEqual([position.toArray(), dist], [[2.5, 2, 3.5], 1])
  })

  it('leaves defaults of skills to the skill', async () => {
    await run('await goToPosition(bot, new Vec3(1, 2, 3))')
    assert.strictEqual(bot.calls[0][2], 2)
  })

  it('runs a whole function with bot, the last async one of several', async () => {
    assert.strictEqual(await logged('function helper(b) { console.log("no") }\nasync function main(b) { console.log(b === bot, b.username) }'), 'true sally')
  })

  it('keeps the identity of entities and sees them move', async () => {
    bot.waitForTicks = async () => { bot.entities[2].position = new Vec3(9, 2, 4) }
    assert.strictEqual(await logged(`
      const anne = bot.players.anne.entity
      const before = anne.position.x
      await bot.waitForTicks(1)
      console.log(anne === bot.entities[2], before, anne.position.x, bot.entity === bot.players.sally.entity)`), 'true 4 9 true')
  })

  it('copies blocks with their properties and looks them up again when they come back', async () => {
    assert.strictEqual(await logged(`
      const block = bot.blockAt(new Vec3(9, 1, 0))
      console.log(block.name, block.position, block.getProperties().powered, block.secret, bot.blockAt(new Vec3(0, -1, 0)))
      await bot.dig(block)`), 'lever (9, 1, 0) false undefined null')
    assert.ok(bot.calls[0][1] instanceof FakeBlock)
    assert.deepStrictEqual(bot.calls[0][1].position.toArray(), [9, 1, 0])
  })

  it('asks a matcher of the program once per block state', async () => {
    assert.strictEqual(await logged(`
      let asked = 0
      const found = bot.findBlocks({ matching: (block) => { asked++; return block.name === 'lever' && block._properties.powered === false }, count: 5 })
      console.log(found, asked)`), '[(9, 0, 0)] 2')
  })

  it('hands items over as copies that stand for their slot', async () => {
    bot.equip = async (item) => { bot.calls.push(['equip', item]) }
    await logged('await bot.equip(bot.inventory.items()[0], "hand")')
    assert.strictEqual(bot.calls[0][1], bot.inventory.slots[1])
    const gone = await run('const item = bot.inventory.items()[0]; await echo(bot, 1); await bot.equip({ ...item }, "hand")')
    assert.match(gone.error.message, /must be an item/)
  })

  it('refuses an item that is no longer in its slot', async () => {
    scope.lose = async () => { bot.inventory.slots[1] = null }
    bot.equip = async () => {}
    const { error } = await run('const item = bot.inventory.items()[0]\nawait lose()\nawait bot.equip(item, "hand")')
    assert.match(error.message, /argument 1 of bot.equip: the item is not in slot 1 any more/)
    assert.strictEqual(error.line, 3)
  })

  it('opens windows and closes them', async () => {
    let opened
    bot.openContainer = async () => (opened = bot.inventory)
    assert.strictEqual(await logged(`
      const chest = await bot.openContainer(bot.blockAt(new Vec3(1, 1, 1)))
      console.log(chest.items().map((item) => item.name + item.count), chest.slots[0])
      chest.close()`), '["diamond3"] null')
    assert.strictEqual(opened.closed, true)
  })

  it('names recipes, so that one can be crafted', async () => {
    await logged('const [recipe] = bot.recipesFor(7, null, 1, null); console.log(recipe.delta[0].count); await bot.craft(recipe, 2, null)')
    const [, recipe, count] = bot.calls[0]
    assert.deepStrictEqual([recipe.result.id, count], [7, 2])
  })

  it('builds goals in the host', async () => {
    await logged('await bot.pathfinder.goto(new goals.GoalCompositeAny([new goals.GoalNear(1, 2, 3, 1), new goals.GoalFollow(bot.entities[2], 2)]))')
    const [, goal] = bot.calls[0]
    assert.ok(goal instanceof goals.GoalCompositeAny)
    assert.ok(goal.goals[0] instanceof goals.GoalNear)
    assert.strictEqual(goal.goals[1].entity, bot.entities[2])
  })

  it('turns functions of the program into functions of the host, async ones too', async () => {
    assert.strictEqual(await logged(`
      console.log(await exploreUntil(bot, new Vec3(0, 0, 1), 5, (step) => step === 3 ? bot.blockAt(new Vec3(9, 0, 0)) : null).then((b) => b.name))
      console.log(await exploreUntil(bot, new Vec3(0, 0, 1), 5, async (step) => { await null; return step === 2 && 'two' }))`), 'lever\ntwo')
  })

  it('reports an error of a callback where it was thrown', async () => {
    const { error } = await run('await exploreUntil(bot, new Vec3(0, 0, 1), 5, (step) => {\n  throw new Error("step " + step)\n})')
    assert.deepStrictEqual(error, { message: 'step 1', line: 2, column: 9, skill: 'exploreUntil', kind: 'skill' })
  })

  it('reports it there too if the skill wraps the error', async () => {
    scope.wrap = async (callback) => {
      try {
        callback()
      } catch (cause) {
        throw new Error(`wrap: ${cause.message}`, { cause })
      }
    }
    const { error } = await run('await wrap(() => {\n  null.x\n})')
    assert.deepStrictEqual([error.message, error.line, error.skill], ["wrap: cannot read property 'x' of null", 2, 'wrap'])
  })

  it('copies plain data both ways, special numbers and dates of keys included', async () => {
    assert.strictEqual(await logged(`
      const value = await echo(bot, { a: [1, 'x', null, undefined, true], $: 'v', n: -0, nested: { v: new Vec3(1, 2, 3) } })
      console.log(value.a, value.$, Object.is(value.n, -0), value.nested.v.plus(new Vec3(1, 1, 1)))`), '[1, "x", null, undefined, true] v true (2, 3, 4)')
  })

  it('shows mcData entry by entry and read-only', async () => {
    assert.strictEqual(await logged(`
      console.log(mcData.blocksByName.stone.hardness, mcData.blocksByName.nothing, Object.keys(mcData.blocksByName), 'lever' in mcData.blocksByName)
      console.log(mcData.version.minecraftVersion, mcData.version.isNewer, bot.registry.itemsByName.diamond.id)
      for (const act of [() => { mcData.blocksByName.stone = 1 }, () => { 'use strict'; mcData.blocksByName.stone.hardness = 0 }, () => { delete mcData.blocksByName.stone }]) {
        try { act(); console.log('changed') } catch (error) { console.log(error.name) }
      }`), '1.5 undefined ["stone", "lever"] true\n1.20.4 undefined 7\nTypeError\nTypeError\nTypeError')
  })

  it('calls listeners with what the events carry, and none after the end', async () => {
    scope.shout = async () => { bot.emit('chat', 'anne', 'hi', 'extra', process) }
    assert.strictEqual(await logged(`
      const once = []
      bot.once('chat', (name) => once.push(name))
      const listener = (...args) => console.log(args)
      bot.on('chat', listener)
      await shout()
      bot.removeListener('chat', listener)
      await shout()
      bot.on('health', listener)
      console.log(once)`), '["anne", "hi"]\n["anne"]')
    assert.deepStrictEqual([bot.listenerCount('chat'), bot.listenerCount('health')], [0, 0])
  })

  it('keeps an event it cannot hand over from harming who emitted it', async () => {
    scope.shout = async () => { bot.emit('entityMoved', { get position () { throw new Error('broken') } }); bot.emit('move', 7) }
    const { error } = await run('bot.on("move", () => {}); await shout(); await bot.waitForTicks(1000)')
    assert.deepStrictEqual([error.skill, error.kind], ['bot.on move', 'skill'])
  })

  it('runs timers, clears them, and none after the end', async () => {
    assert.strictEqual(await logged(`
      const stopped = setTimeout(() => console.log('stopped'), 1)
      clearTimeout(stopped)
      let count = 0
      await new Promise((resolve) => { const each = setInterval((by) => { count += by; if (count === 4) { clearInterval(each); resolve() } }, 1, 2) })
      setTimeout(() => console.log('late'), 0)
      console.log(count)`), '4')
  })

  it('fails if a listener or a timer fails, async ones too', async () => {
    scope.shout = async () => { bot.emit('chat', 'anne', 'hi') }
    for (const start of ['bot.on("chat", ', 'setTimeout(']) {
      for (const how of ['() => {', 'async () => {\n  await null;']) {
        const { ok, error } = await run(`${start}${how}\n  null.x\n}); await shout(); await bot.waitForTicks(1000)`)
        assert.deepStrictEqual([ok, error.message, error.line], [false, "TypeError: cannot read property 'x' of null", how.includes('async') ? 3 : 2])
      }
    }
  })

  it('takes time and chance from the host', async (t) => {
    t.mock.method(Date, 'now', () => Date.UTC(2024, 0, 2, 3, 4, 5))
    t.mock.method(Math, 'random', () => 0.25)
    assert.strictEqual(await logged('console.log(Date.now(), new Date().getHours(), new Date(0).getFullYear(), Math.random())'), `${Date.UTC(2024, 0, 2, 3, 4, 5)} 3 1970 0.25`)
  })

  it('names what was still under way at the end', async () => {
    const { ok, unfinished } = await run('never(); bot.waitForTicks(5)')
    assert.deepStrictEqual([ok, unfinished], [true, [{ what: 'never', line: 1 }, { what: 'bot.waitForTicks', line: 1 }]])
  })

  it('ends when the signal is aborted, before and during the run', async () => {
    const early = await run('console.log(1)', { signal: AbortSignal.abort() })
    assert.deepStrictEqual([early.ok, early.error.kind, early.log], [false, 'aborted', []])
    const controller = new AbortController()
    scope.abort = async () => { controller.abort() }
    const { ok, error, log } = await run('console.log(1)\nawait abort()\nconsole.log(2)', { signal: controller.signal })
    assert.deepStrictEqual([ok, error.kind, error.line, log.length], [false, 'aborted', 2, 1])
  })

  it('uses the same fuel for the same program', async () => {
    const code = 'let sum = 0; for (let i = 0; i < 1000; i++) sum += i; await goToPosition(bot, new Vec3(sum, 1, 2))'
    const amounts = []
    for (let i = 0; i < 3; i++) amounts.push((await run(code)).fuel)
    assert.strictEqual(new Set(amounts).size, 1)
    assert.ok(amounts[0] > 1000)
  })

  it('says which lines ran', async () => {
    const { lines } = await run('let x = 1\nif (x > 1) {\n  x = 2\n} else {\n  x = 3\n}\nfunction f() {\n  return 1\n}\nx = 4')
    assert.deepStrictEqual(lines, [1, 2, 5, 10])
  })
})
