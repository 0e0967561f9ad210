'use strict'
/** Promises that are rejected without a handler are errors of the program, as in Node. */
const assert = require('node:assert/strict')
const { before, beforeEach, describe, it } = require('node:test')
const { createSandbox } = require('../../src/sandbox')
const { fakeBot, fakeScope } = require('./fake-world')

const FAR = 'new Vec3(1, 200, 3)'

describe('a rejected promise', () => {
  let sandbox
  let bot
  before(() => { sandbox = createSandbox({ fuel: 20_000_000 }) })
  beforeEach(() => { bot = fakeBot() })
  const run = code => sandbox.run({ code, bot, scope: fakeScope(bot) })

  for (const [what, code, line, column] of [
    ['of a call that is not awaited', `bot.chat("a")\n  goToPosition(bot, ${FAR})\nawait never()\nbot.chat("b")`, 2, 3],
    ['of an async function that is not awaited', `async function walk() {\n  await goToPosition(bot, ${FAR})\n}\nwalk()\nawait never()\nbot.chat("b")`, 2, 9],
    ['of an async callback of forEach', `[1, 2].forEach(async (n) => {\n  await goToPosition(bot, ${FAR})\n})\nawait never()\nbot.chat("b")`, 2, 9],
    ['of a chain without catch', `bot.waitForTicks(1).then(() =>\n  goToPosition(bot, ${FAR}))\nawait never()\nbot.chat("b")`, 2, 3],
    ['that is awaited too late', `const p = goToPosition(bot, ${FAR})\nawait never()\nbot.chat("b")\nawait p`, 1, 11]
  ]) {
    it(`${what} ends the program, and says where and which skill`, async () => {
      const { ok, error } = await run(code)
      assert.equal(ok, false)
      assert.deepEqual([error.kind, error.skill, error.line, error.column], ['skill', 'goToPosition', line, column])
      assert.match(error.message, /^cannot reach .* \(nothing waited for this promise/)
      assert.ok(!bot.calls.some(([name, text]) => name === 'chat' && text === 'b'))
    })
  }

  it('of the last statement is told although the program has ended', async () => {
    const { ok, error } = await run('(async () => { throw new TypeError("late") })()')
    assert.deepEqual([ok, error.kind], [false, 'error'])
    assert.match(error.message, /^TypeError: late \(nothing/)
  })

  it('gives way to the error that the program itself ends with', async () => {
    const { error } = await run('Promise.reject(new Error("stray"))\nthrow new Error("own")')
    assert.equal(error.message, 'own')
  })

  for (const [what, code] of [
    ['caught at once', `await goToPosition(bot, ${FAR}).catch(() => {})`],
    ['caught in the same turn', `const p = goToPosition(bot, ${FAR})\np.catch(() => {})\nawait bot.waitForTicks(3)`],
    ['awaited in try', `try { await goToPosition(bot, ${FAR}) } catch {}`],
    ['one of all', `await Promise.all([goToPosition(bot, ${FAR}), goToPosition(bot, ${FAR})]).catch(() => {})`],
    ['one of all settled', `await Promise.allSettled([goToPosition(bot, ${FAR}), bot.waitForTicks(2)])`],
    ['the loser of a race', `await Promise.race([bot.waitForTicks(1), bot.waitForTicks(2).then(() => { throw 1 })])\nawait bot.waitForTicks(4)`],
    ['caught by a callback of a skill', 'await exploreUntil(bot, new Vec3(1, 0, 0), 3, async () => { throw new Error("no") }).catch(() => {})']
  ]) {
    it(`is no error: ${what}`, async () => {
      const { ok, error } = await run(code)
      assert.equal(ok, true, error?.message)
    })
  }

  it('after the end is none, and the next program runs', async () => {
    assert.equal((await run('bot.waitForTicks(3).then(() => { throw new Error("late") })')).ok, true)
    // The program's ticks began before these, so that they have passed too.
    await bot.waitForTicks(3)
    assert.equal((await run('await bot.waitForTicks(1)')).ok, true)
  })

  it('is told when what a callback gives cannot be used', async () => {
    const { error } = await run('await exploreUntil(bot, new Vec3(1, 0, 0), 3, async () => NaN)')
    assert.match(error.message, /the result of the callback must be a finite number, found NaN/)
  })
})
