'use strict'
const assert = require('node:assert/strict')
const { once } = require('node:events')
const { after, before, describe, it } = require('node:test')
const { agent, floor, Node, region, THREE } = require('./harness')
const { Runner } = require('../src/runner')

describe('programs', () => {
  let node
  let regions = 0
  before(async () => {
    node = new Node()
    await node.hello()
  })
  after(() => node.close())

  /** Run programs in a new region. Return the tick, the results and the frames of the run. */
  async function run (programs, timeoutTicks = 100, more = {}) {
    const name = `region ${regions++}`
    await node.request('create_region', region(name, more))
    node.frames.length = 0
    const answer = await node.request('run', { region: name, programs, timeout_ticks: timeoutTicks })
    return { ...answer, name, frames: [...node.frames] }
  }

  it('go on together, tick by tick, until the last has ended', async () => {
    const say = ticks => `for (let i = 0; i < ${ticks}; i++) { bot.chat('tick ' + i); await bot.waitForTicks(1) }`
    const { tick, results, frames } = await run({ sally: say(3), anne: say(6) })
    assert.equal(tick, results.anne.ticks)
    assert.ok(results.sally.ticks < results.anne.ticks)
    const said = frames.map(frame => frame.events.filter(event => event.kind === 'chat').map(event => event.actor).join())
    // Programs begin in the given order; bots move in order of their names. Code before the first wait belongs to the
    // first tick, like the code after it.
    assert.deepEqual(said.filter(Boolean), ['sally,anne,anne,sally', 'anne,sally', 'anne', 'anne', 'anne'])
  })

  it('may be one whole function', async () => {
    const { frames } = await run({ sally: "async function greet(bot) { bot.chat('hello') }" })
    assert.equal(frames[0].events[0].detail.text, 'hello')
  })

  it('take one tick at least, in which what they did is told', async () => {
    const { tick, results, frames } = await run({ sally: "bot.chat('hello')" })
    assert.equal(tick, 1)
    assert.equal(results.sally.ticks, 1)
    assert.equal(frames[0].tick, 1)
  })

  it('that fail say where, and leave the others alone', async () => {
    const { results } = await run({
      sally: 'bot.chat("a")\nawait bot.waitForTicks(2)\n  undefinedName()',
      anne: 'await bot.waitForTicks(5)',
      observer: 'this is no program'
    })
    const { error } = results.sally
    assert.deepEqual([error.line, error.column], [3, 3])
    assert.match(error.message, /undefinedName/)
    assert.deepEqual(results.anne, { ok: true, error: null, lines: [1], log: [], unfinished: [], aims: [], ticks: results.anne.ticks })
    assert.equal(results.observer.error.kind, 'syntax')
  })

  it('are told by what they asked to make for, whether or not it is there', async () => {
    const { results } = await run({
      sally: "try { await getItemFromChest(bot, new Vec3(1, 1, 2), {diamond: 1}) } catch {}\nawait goToPosition(bot, bot.entity.position)\nsay(bot, 'I go to (9, 9, 9)')"
    })
    const { aims } = results.sally
    assert.deepEqual(aims.map(({ call, uses }) => [call, uses]), [['getItemFromChest', true], ['goToPosition', false]])
    assert.deepEqual(aims[0].place, [1, 1, 2])
    assert.equal(aims[0].agent, null)
  })

  it('say that there is no way, if that is why they failed', async () => {
    const { results } = await run({ sally: 'await goToPosition(bot, bot.entity.position.offset(0, 30, 0), 0)' })
    assert.equal(results.sally.error.reason, 'no_way')
  })

  it('are told which name they may have meant', async () => {
    const { results } = await run({ sally: 'await gotoPositon(bot, bot.entity.position)', anne: 'await frobnicate()' })
    assert.match(results.sally.error.message, /gotoPositon.* did you mean goToPosition\?/)
    assert.doesNotMatch(results.anne.error.message, /mean/)
  })

  it('are told what stands here for what other systems have', async () => {
    const { results } = await run({ sally: 'new GoalNear(1, 2, 3, 1)', anne: "const mineflayer = require('mineflayer')" })
    assert.match(results.sally.error.message, /GoalNear.*; write goals\.GoalNear/)
    assert.match(results.anne.error.message, /require.*a program loads no modules/)
  })

  it('name the skill that failed', async () => {
    const { results } = await run({ sally: '\nawait goToPosition(bot, "there")' })
    assert.equal(results.sally.error.skill, 'goToPosition')
    assert.equal(results.sally.error.line, 2)
  })

  it('tell which of their own lines ran, and what they wrote', async () => {
    const { results } = await run({
      sally: 'const n = 2\nif (n > 3) {\n  bot.chat("never")\n}\nconsole.log("n", n, [n])',
      anne: 'console.warn("a")\nawait bot.waitForTicks(1)\nthrow new Error("b")\nconsole.log("c")',
      observer: 'let a = ;'
    })
    assert.deepEqual([results.sally.lines, results.sally.log], [[1, 2, 5], ['n 2 [2]']])
    assert.deepEqual([results.anne.lines, results.anne.log, results.anne.error.line], [[1, 2, 3], ['a'], 3])
    assert.deepEqual([results.observer.lines, results.observer.log], [[], []])
  })

  it('tell what was still going on at their end, and it is stopped', async () => {
    const { name, results } = await run({
      sally: 'setInterval(() => bot.chat("late"), 50)\ngoToPosition(bot, new Vec3(9, -51, 9))\nawait bot.waitForTicks(3)',
      anne: 'bot.setControlState("forward", true)\nawait bot.waitForTicks(5)',
      observer: 'await goToPosition(bot, new Vec3(3, -51, 8))\nbot.pathfinder.setGoal(new goals.GoalNear(9, -51, -9, 0))\nawait bot.waitForTicks(5)'
    })
    assert.equal(results.sally.ok, true)
    assert.deepEqual(results.sally.unfinished, [
      { what: 'goToPosition', line: 2 }, { what: 'setInterval', line: 1 }, { what: 'a walk', line: null }
    ])
    assert.deepEqual(results.anne.unfinished, [{ what: 'a movement', line: null }])
    assert.deepEqual(results.observer.unfinished, [{ what: 'a walk', line: null }])
    await node.request('step', { region: name, ticks: 20 })
    node.frames.length = 0
    await node.request('step', { region: name, ticks: 20 })
    assert.deepEqual(node.frames, [])
  })

  it('leave nothing unfinished when they wait for what they begin', async () => {
    const chest = [3, -51, 3, 2955]
    const { results } = await run({
      sally: 'await depositItemIntoChest(bot, new Vec3(3, -51, 3), { diamond: 1 })\nawait goToPosition(bot, new Vec3(-5, -51, -5))',
      anne: 'await bot.pathfinder.goto(new goals.GoalNear(-7, -51, -7, 1))'
    }, 400, { blocks: floor([chest]), containers: [[3, -51, 3, {}]], agents: { ...THREE(), sally: agent([0.5, -51, 0.5], { inventory: { diamond: 1 } }) } })
    assert.deepEqual([results.sally.error, results.anne.error], [null, null])
    assert.deepEqual([results.sally.unfinished, results.anne.unfinished], [[], []])
  })

  it('that run out of ticks or of fuel tell as much', async () => {
    const { results } = await run({
      sally: 'console.log("on my way")\nawait goToPosition(bot, new Vec3(9, -51, 9))\nconsole.log("there")',
      anne: 'console.log("round")\nfor (;;) {}'
    }, 5)
    const { kind, line, message } = results.sally.error
    assert.deepEqual([kind, line, message], ['timeout', 2, 'the program did not end within 5 ticks'])
    assert.deepEqual([results.sally.lines, results.sally.log], [[1, 2], ['on my way']])
    assert.deepEqual(results.sally.unfinished, [{ what: 'goToPosition', line: 2 }, { what: 'a walk', line: null }])
    assert.deepEqual([results.anne.error.kind, results.anne.lines, results.anne.log], ['fuel', [1, 2], ['round']])
  })

  it('cannot write without end', async () => {
    const { results: { sally, anne } } = await run({
      sally: 'for (let i = 0; i < 1500; i++) console.log(i)', anne: 'console.log("x".repeat(90000))\nconsole.log("y")'
    })
    assert.equal(sally.log.length, 1000)
    assert.match(sally.log[999], /^999 .*left out/)
    assert.equal(anne.log.length, 1)
    assert.ok(anne.log[0].length < 51000)
  })

  it('that do not wait for a skill that fails fail with it, and the others go on', async () => {
    const { results } = await run({
      sally: 'giveItemToOther(bot, "anne", "dirt", 1).catch(() => {})\n  giveItemToOther(bot, "anne", "dirt", 1)\nawait bot.waitForTicks(20)',
      anne: 'await bot.waitForTicks(5)'
    })
    const { kind, skill, line, column } = results.sally.error
    assert.deepEqual([kind, skill, line, column], ['skill', 'giveItemToOther', 2, 3])
    assert.equal(results.anne.ok, true)
  })

  it('are ended at the time limit, and their bots stand still then', async () => {
    const { name, tick, results } = await run({
      sally: 'bot.setControlState("forward", true); setInterval(() => bot.chat("still here"), 50); await new Promise(() => {})'
    }, 20)
    assert.equal(tick, 20)
    assert.equal(results.sally.error.kind, 'timeout')
    assert.equal(results.sally.ticks, 20)
    await node.request('step', { region: name, ticks: 20 })
    node.frames.length = 0
    await node.request('step', { region: name, ticks: 20 })
    assert.deepEqual(node.frames, [])
  })

  it('end with their bot at rest, although a path was not walked to its end', async () => {
    const { name } = await run({ sally: 'bot.pathfinder.setGoal(new goals.GoalNear(9, -51, 9, 0)); await bot.waitForTicks(8)' })
    await node.request('step', { region: name, ticks: 20 })
    node.frames.length = 0
    await node.request('step', { region: name, ticks: 20 })
    assert.deepEqual(node.frames, [])
  })

  it('of endless computation are ended by what they use up', async () => {
    const { results } = await run({ sally: 'for (;;) {}' })
    assert.equal(results.sally.ok, false)
    assert.equal(results.sally.error.kind, 'fuel')
  })

  it('cannot change how later programs find their way', async () => {
    const { name, results } = await run({
      sally: `const movements = new Movements(bot)
        movements.canDig = true
        movements.digCost = -5
        bot.pathfinder.setMovements(movements)
        bot.pathfinder.thinkTimeout = 0
        bot.pathfinder.searchRadius = 1`
    })
    assert.equal(results.sally.error, null)
    const again = await node.request('run', {
      region: name, programs: { sally: 'console.log(bot.pathfinder.thinkTimeout, bot.pathfinder.searchRadius)\nawait goToPosition(bot, new Vec3(7, -51, 7))' }, timeout_ticks: 200
    })
    assert.equal(again.results.sally.error, null)
    assert.deepEqual(again.results.sally.log, ['5000 -1'])
  })

  it('that close a window under a transfer cannot stop time', async () => {
    const race = `const chest = await bot.openChest(bot.blockAt(new Vec3(2, -51, 2)))
      const { id } = bot.registry.itemsByName.dirt
      for (let i = 0; i < 6; i++) chest.deposit(id, null, 1).catch(error => console.log(error.message))
      chest.close()
      bot.toss(id, null, 1).catch(error => console.log(error.message))
      await bot.waitForTicks(10)`
    const { name, results } = await run({ sally: race, anne: 'await bot.waitForTicks(5)' }, 100, {
      blocks: floor([[2, -51, 2, 2955]]), containers: [[2, -51, 2, {}]],
      agents: { ...THREE(), sally: agent([0.5, -51, 0.5], { inventory: { dirt: 10 } }) }
    })
    assert.equal(results.anne.error, null)
    assert.match(results.sally.log.join(), /packets were sent at once/)
    const again = await node.request('run', { region: name, programs: { sally: 'await goToPosition(bot, new Vec3(-3, -51, 3))' }, timeout_ticks: 200 })
    assert.equal(again.results.sally.error, null)
  })

  it('search for a path without end only as long as time allows', async () => {
    const { tick, results } = await run({ sally: 'await bot.pathfinder.goto(new goals.GoalNear(300, -51, 300, 0))' }, 400)
    assert.ok(tick <= 400)
    assert.equal(results.sally.ok, false)
  })
})

describe('limits of programs where ticks pass by themselves', () => {
  /** Run a program that takes a number of ticks of this process, while `jump` ticks pass in each. Return its result. */
  async function run (needed, jump, timeoutTicks) {
    const region = { tick: 0, faults: [], body: () => ({ bot: bodiless }) }
    let turns = 0
    const { promise, resolve } = Promise.withResolvers()
    const regions = {
      get: () => region,
      clock: { advance: () => new Promise(setImmediate) },
      bodies: { rest: async () => {}, stand: async () => true, finish: async () => {} },
      resumed: async (_, action) => { await action(); return { tick: region.tick } },
      async tick (_, before) {
        region.tick += jump
        if (++turns === needed) resolve({ ok: true, error: null, lines: [], log: [], unfinished: [] })
        await new Promise(setImmediate)
        await before()
      }
    }
    const ended = ({ signal }) => Promise.race([promise, once(signal, 'abort').then(() => ({ ok: false, error: null, lines: [], log: [], unfinished: [] }))])
    const { results } = await new Runner(regions, ended, () => ({})).run('/', { sally: '' }, timeoutTicks)
    return results.sally
  }
  const bodiless = { pathfinder: { setGoal () {}, reset () {} }, getControlState: () => false, clearControlStates () {}, deactivateItem () {}, _client: {} }

  it('count the ticks that this process could follow', async () => {
    const { ok, ticks } = await run(10, 100, 20)
    assert.deepEqual([ok, ticks], [true, 1000])
  })

  it('end a program at its limit', async () => {
    const { error, ticks } = await run(30, 1, 20)
    assert.deepEqual([error.kind, ticks], ['timeout', 20])
  })
})
