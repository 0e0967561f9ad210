'use strict'
/** Programs that misuse a real bot. Each ends; the others and the next one run as if nothing had happened. */
const assert = require('node:assert/strict')
const { after, before, describe, it } = require('node:test')
const registry = require('minecraft-data')('1.20.4')
const { agent, floor, Node, region, THREE } = require('./harness')

const state = name => registry.blocksByName[name].defaultState
const CHEST = 'bot.blockAt(new Vec3(2, -51, 2))'
const DIRT = registry.itemsByName.dirt.id
const quiet = call => `${call}.catch(() => {})`
const goal = made => `bot.pathfinder.setGoal(${made}, true)`

const MISUSES = {
  'goals that cannot be reached': goal('new goals.GoalPlaceBlock(new Vec3(300, -51, 3), bot.world, { range: 4, facing: "north" })'),
  'a goal away from oneself': goal('new goals.GoalInvert(new goals.GoalFollow(bot.entity, 3))'),
  'costs below zero': 'const m = new Movements(bot); m.canDig = true; m.digCost = -5; m.maxDropDown = 1e9; bot.pathfinder.setMovements(m); ' + goal('new goals.GoalNear(9, -51, 9, 0)'),
  'goals set while goals are set': 'bot.on("goal_updated", () => bot.pathfinder.setGoal(new goals.GoalNear(9, -51, 9, 0))); bot.pathfinder.setGoal(null)',
  'goals set and dropped in every tick': 'bot.on("physicsTick", () => bot.pathfinder.setGoal(bot.pathfinder.isMoving() ? null : new goals.GoalNear(9, -51, 9, 0)))',
  'walks that stop each other': [1, 2].map(x => quiet(`bot.pathfinder.goto(new goals.GoalNear(${x * 4}, -51, 9, 0))`)).join(';') + '; bot.pathfinder.stop()',
  'digging twice and walking on': `const b = bot.blockAt(bot.entity.position.offset(0, -1, 0)); ${quiet('bot.dig(b)')}; ${quiet('bot.dig(b)')}; bot.setControlState("forward", true)`,
  'windows opened and closed in a heap': `for (let i = 0; i < 5; i++) bot.openChest(${CHEST}).then(c => c.close()).catch(() => {})`,
  'a window closed as it opens': `bot.on("windowOpen", w => w.close()); ${quiet(`bot.openChest(${CHEST})`)}`,
  'a window closed as it closes': `let n = 0; bot.on("windowClose", w => { if (n++ < 5) bot.closeWindow(w) }); (await bot.openChest(${CHEST})).close()`,
  'transfers at the same time': `const c = await bot.openChest(${CHEST}); for (let i = 0; i < 6; i++) { ${quiet(`c.deposit(${DIRT}, null, 1)`)}; ${quiet(`bot.toss(${DIRT}, null, 1)`)} }; c.close()`,
  'what is opened is no container': `${quiet('bot.openFurnace(bot.blockAt(new Vec3(1, -52, 1)))')}; ${quiet('bot.openBlock(bot.blockAt(new Vec3(1, -52, 1)))')}; ${quiet('bot.openContainer(bot.entity)')}`,
  'everything worn at once': ['hand', 'head', 'feet', 'off-hand'].map(place => quiet(`bot.equip(${DIRT}, "${place}")`)).join(';'),
  'hitting oneself and others': 'bot.attack(bot.entity); bot.useOn(bot.players.anne.entity); ' + quiet('bot.activateEntity(bot.entity)'),
  'turning round and round': `${quiet('bot.look(1000, -1000, true)')}; ${quiet('bot.look(-999, 999)')}; ${quiet('bot.lookAt(bot.entity.position.offset(0, 1.62, 0))')}`,
  'strange words': String.raw`for (const words of ["", "\u0000", "\ud800", "%s {0}", '{"text": []}']) bot.chat(words); bot.whisper("nobody", "x")`,
  'eating nothing, twice': `${quiet('bot.consume()')}; ${quiet('bot.consume()')}; bot.deactivateItem(); bot.setQuickBarSlot(3)`,
  'packets without end, and what stops the bot': 'bot.activateItem(); for (let i = 0; i < 6000; i++) try { bot.swingArm() } catch {}',
  'throwing in a listener': 'bot.on("physicsTick", () => { throw new Error("mine") })'
}

describe('a program that misuses its bot', () => {
  let node
  before(async () => {
    node = new Node()
    await node.hello()
    const sally = agent([0.5, -51, 0.5], { inventory: { dirt: 30 } })
    const blocks = floor([[2, -51, 2, state('chest')]])
    await node.request('create_region', region('hall', { blocks, containers: [[2, -51, 2, {}]], agents: { ...THREE(), sally } }))
  })
  after(() => node.close())

  const run = programs => node.request('run', { region: 'hall', programs, timeout_ticks: 400 })

  for (const [what, code] of Object.entries(MISUSES)) {
    it(`harms nobody: ${what}`, async () => {
      const { results } = await run({ sally: `${code}\nawait bot.waitForTicks(12)`, anne: 'await bot.waitForTicks(8)' })
      assert.deepEqual([results.anne.ok, results.anne.unfinished], [true, []])
      assert.ok(results.sally.error === null || ['error', 'refused', 'stack'].includes(results.sally.error.kind), results.sally.error?.message)
      const next = await run({ sally: 'await goToPosition(bot, new Vec3(0, -51, 0), 0)' })
      assert.deepEqual([next.results.sally.error, next.results.sally.unfinished], [null, []])
    })
  }
})
