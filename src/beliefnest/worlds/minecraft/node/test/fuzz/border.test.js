'use strict'
/**
 * Random variations of known attacks: texts with lone surrogates on every way out, built-ins replaced in any
 * combination, raw messages of timers, programs of odd texts.
 *
 * BELIEFNEST_NIGHTLY=1 tries thousands; BELIEFNEST_FUZZ_SEED=17 repeats those of one seed.
 */
const assert = require('node:assert/strict')
const { before, describe, it } = require('node:test')
const { createSandbox } = require('../../src/sandbox')
const { prepareProgram, ProgramSyntaxError } = require('../../src/sandbox/program')
const { Session } = require('../../src/sandbox/session')
const { fakeBot, fakeScope } = require('../sandbox/fake-world')
const { messagesOf, PATCHES, USES } = require('../sandbox/patches')
const { generator } = require('./generate')

const only = process.env.BELIEFNEST_FUZZ_SEED
const many = process.env.BELIEFNEST_NIGHTLY === '1' ? 2000 : 15
const SEEDS = only === undefined ? Array.from({ length: many }, (_, i) => i + 1) : [Number(only)]

const PIECES = ['\\ud83d', '\\ude00', '😀', 'a', '\\u2028', '\\u0000', '\\u001b', '\\n', '"', '\\\\', '/', '\\uffff', 'é', 'x'.repeat(3000)]
const WAYS = [(t) => `console.log(${t})`, (t) => `console.log({ [${t}]: [${t}] })`, (t) => `bot.chat(${t})`, (t) => `await echo(bot, ${t})`,
  (t) => `await echo(bot, new Error(${t}))`, (t) => `throw ${t}`, (t) => `throw new TypeError(${t})`, (t) => `throw Object.assign(new Error("e"), { name: ${t}, stack: ${t} })`,
  (t) => `await exploreUntil(bot, new Vec3(1, 0, 0), 1, async () => { throw new Error(${t}) })`, (t) => `bot.on(${t}, () => {})`, (t) => `bot.players[${t}].entity`,
  (t) => `mcData.blocksByName[${t}].name`, (t) => `Promise.reject(${t})`, (t) => `bot.blockAt({ x: ${t}, y: 1, z: 2 })`]

const pick = (random, list) => list[random.below(list.length)]
const several = (random, most, make) => Array.from({ length: 1 + random.below(most) }, make)

function textsIn (value) {
  if (typeof value === 'string') return [value]
  return value !== null && typeof value === 'object' ? Object.entries(value).flatMap(([key, item]) => [key, ...textsIn(item)]) : []
}

describe('neighbours of known attacks', () => {
  let sandbox
  let honest
  before(async () => {
    sandbox = createSandbox({ fuel: 15_000_000 })
    honest = await messagesOf(sandbox, USES)
  })

  it('let no half character out', async () => {
    for (const seed of SEEDS) {
      const random = generator(seed)
      const text = () => `"${several(random, 6, () => pick(random, PIECES)).join('').replaceAll(/(?<!\\)"/g, '\\"')}"`
      const code = several(random, 3, () => pick(random, WAYS)(text())).map((line) => random.chance(60) ? `try { ${line} } catch {}` : line).join('\n')
      const bot = fakeBot()
      const report = await sandbox.run({ code, bot, scope: fakeScope(bot) })
      for (const each of textsIn([report, bot.calls.filter(([call]) => call === 'chat')])) assert.ok(each.isWellFormed(), `seed ${seed}: ${code}`)
      if (report.error) assert.ok(report.error.message.length < 4200, `seed ${seed}`)
    }
  })

  it('say nothing at the border that other programs do not', async () => {
    for (const seed of SEEDS) {
      const random = generator(seed)
      const patches = several(random, 4, () => pick(random, Object.values(PATCHES)))
      const messages = await messagesOf(sandbox, `${patches.map((patch) => `try { ${patch} } catch {}`).join('\n')}\n${USES}`)
      for (const message of messages) {
        // A broken program may say anything about its own errors.
        assert.ok(honest.includes(message) || /^\["(log|settled)",/.test(message), `seed ${seed}: ${message} after ${patches.join('\n')}`)
      }
    }
  })

  it('leave no timer behind', (t) => {
    const running = new Set()
    for (const what of ['Timeout', 'Interval']) {
      t.mock.method(globalThis, `set${what}`, () => { const timer = {}; running.add(timer); return timer })
      t.mock.method(globalThis, `clear${what}`, (timer) => running.delete(timer))
    }
    for (const seed of SEEDS) {
      const random = generator(seed)
      const guest = { charge: () => true, result: () => null, send: () => ({ ok: true, value: { now: { $: 'u' } } }), end () {}, idle: true, lastStatement: 0 }
      const session = new Session(guest, { bot: fakeBot(), skills: {}, data: null, random: () => 0.5 })
      const ids = [0, 1, 2, 3, -1, '1', null, 1.5, [1], { id: 1 }, 2 ** 53]
      for (let turn = 0; turn < 200; turn++) {
        const message = random.chance(70) ? ['timer', pick(random, ids), pick(random, [0, 1, 1e6, -1, null]), random.chance(50)] : ['untimer', pick(random, ids)]
        session.answer(JSON.stringify(message))
      }
      session.finish({ ok: true })
      assert.equal(running.size, 0, `seed ${seed}`)
    }
  })

  it('are read or refused, and every place in them is one of the program', () => {
    const parts = ['0', ';', '\n', '\r\n', '\u2028', 'let a', '=', 'f(', ')', '(', '{', '}', 'new X', '.b', '`', '/x/', '__ran_', '//', 'async ', '=>', '"', '😀', '\ud83d']
    for (const seed of SEEDS) {
      const random = generator(seed)
      const code = several(random, 60, () => pick(random, parts).repeat(random.chance(5) ? 500 : 1)).join(random.chance(50) ? ' ' : '')
      const lines = code.split(/\r\n|[\n\r\u2028\u2029]/)
      try {
        const { text, marks, locate, statement, linesOf } = prepareProgram(code, ['bot'])
        const inside = ({ line, column }) => line >= 1 && line <= lines.length && column >= 1 && column <= lines[line - 1].length + 1
        for (let number = 1; number < marks; number++) assert.ok(inside(statement(number)), `seed ${seed}`)
        assert.ok(linesOf(Array.from({ length: marks - 1 }, (_, n) => n + 1)).every((line) => line <= lines.length))
        text.split('\n').forEach((content, row) => {
          for (let column = 1; column <= content.length; column += 7) {
            const place = locate(row + 1, column)
            assert.ok(place === null || inside(place), `seed ${seed}: ${row + 1}, ${column}`)
          }
        })
      } catch (error) {
        if (!(error instanceof ProgramSyntaxError)) throw error
        assert.ok(error.message.isWellFormed() && error.message.length < 1100, `seed ${seed}: ${error.message}`)
      }
    }
  })
})
