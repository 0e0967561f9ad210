'use strict'
/** Texts with lone surrogates: no program can hand one out, whatever way it takes. */
const assert = require('node:assert/strict')
const { before, describe, it } = require('node:test')
const { decode } = require('@msgpack/msgpack')
const { Channel } = require('../../src/channel/channel')
const { createSandbox } = require('../../src/sandbox')
const { fakeBot, fakeScope } = require('./fake-world')

const HALF = '"😀".slice(0, 1)'
const WAYS = {
  'in the console': `console.log(${HALF})`,
  'in the console, within an object': `console.log({ a: [${HALF}] })`,
  'in a chat': `bot.chat("hello " + ${HALF})`,
  'in a whisper': `bot.whisper("anne", ${HALF} + " hello")`,
  'to a skill': `await echo(bot, ${HALF})`,
  'to a skill, within an object': `await echo(bot, { [${HALF}]: [${HALF}] })`,
  'as the name of a skill\'s error': `await echo(bot, Object.assign(new Error(${HALF}), { name: ${HALF} }))`,
  'out of a callback': `await exploreUntil(bot, new Vec3(1, 0, 0), 1, () => ${HALF})`,
  'out of a callback, later': `await exploreUntil(bot, new Vec3(1, 0, 0), 1, async () => ${HALF})`,
  'as what is thrown': `throw ${HALF}`,
  'as a message of what is thrown': `throw new Error(${HALF})`,
  'as a name of what is thrown': `const e = new Error("mine"); e.name = ${HALF}; throw e`,
  'as a stack of what is thrown': `const e = new Error("mine"); e.stack = ${HALF}; throw e`,
  'as what a callback throws': `await exploreUntil(bot, new Vec3(1, 0, 0), 1, () => { throw new Error(${HALF}) })`,
  'as what is cut': `throw new Error("x".repeat(3999) + "😀")`,
  'in what is called, and cut': `const a = {}; a${'.b'.repeat(38)}["😀"]()`,
  'in the name of an event': `bot.on(${HALF}, () => {})`,
  'in the name of an item': `bot.getEquipmentDestSlot(${HALF})`,
  'in the name of a block': `console.log(mcData.blocksByName[${HALF}])`,
  'in its own text': 'console.log("\ud83d")',
  'in its own text, where it is no program': 'let \ud83d = 1'
}

/** Return every text in a value. @returns {string[]} */
function textsIn (value) {
  if (typeof value === 'string') return [value]
  if (value === null || typeof value !== 'object') return []
  return Object.entries(value).flatMap(([key, item]) => [key, ...textsIn(item)])
}

describe('half a character', () => {
  let sandbox
  before(() => { sandbox = createSandbox({ fuel: 15_000_000 }) })

  for (const [way, code] of Object.entries(WAYS)) {
    it(`does not leave a program ${way}`, async () => {
      const bot = fakeBot()
      const heard = []
      const scope = { ...fakeScope(bot), echo: async (own, value) => { heard.push(value) } }
      const report = await sandbox.run({ code, bot, scope })
      for (const text of textsIn([report, heard, bot.calls.filter(([call]) => ['chat', 'whisper'].includes(call))])) {
        assert.ok(text.isWellFormed(), JSON.stringify(text))
      }
    })
  }

  it('becomes another one, and whole ones stay', async () => {
    const code = String.raw`console.log("\ud83d", "😀", "\ud83d\ude00"); console.log(JSON.parse('"\\ud83d"'))`
    const { log } = await sandbox.run({ code, bot: fakeBot(), scope: {} })
    assert.deepEqual(log.map(({ text }) => text), ['\ufffd 😀 😀', '\ufffd'])
  })

  it('is not sent over the channel, in whatever place of a message', () => {
    const sent = []
    new Channel({ on () {}, write: (bytes) => sent.push(bytes) }, () => {}).send({ '\ud83d': ['\ude00', { a: 'x\ud83d', b: '😀' }] })
    assert.deepEqual(decode(sent[0].subarray(4)), { '\ufffd': ['\ufffd', { a: 'x\ufffd', b: '😀' }] })
  })
})
