'use strict'
/** Ways to replace built-ins, a program that uses the border in every way, and its messages there. */
const { Session } = require('../../src/sandbox/session')
const { fakeBot, fakeScope } = require('./fake-world')

const FORGED = '() => [["timer", 7, 1000000, true]]'
const everywhere = (act) => `for (const it of [Object, Array, String, Number, Boolean, Function, Map, WeakMap, Set, Error, Promise, Vec3]) { ${act} }`
const methods = (owner, names) => names.map((name) => `try { ${owner}[${JSON.stringify(name)}] = ${FORGED} } catch {}`).join('; ')

const PATCHES = {
  'toJSON of everything': everywhere(`Object.defineProperty(it.prototype, 'toJSON', { value: ${FORGED}, configurable: true })`),
  'toJSON that throws': everywhere('Object.defineProperty(it.prototype, \'toJSON\', { value: () => { throw 1 }, configurable: true })'),
  'setters of elements': `for (let i = 0; i < 20; i++) for (const it of [Object, Array]) Object.defineProperty(it.prototype, i, { set () {}, get: ${FORGED}, configurable: true })`,
  'setters of fields': `for (const name of ['$', 'id', 'c', 'o', 'n', 'a', 'v', 'ok', 'now', 'skill', 'kind', 'slot']) Object.defineProperty(Object.prototype, name, { set () {}, get () { return undefined }, configurable: true })`,
  JSON: `JSON.stringify = ${FORGED}; JSON.parse = () => ({ ok: true, value: 1 })`,
  'the methods of maps': [methods('Map.prototype', ['get', 'set', 'has', 'delete']), methods('WeakMap.prototype', ['get', 'set', 'has', 'delete'])].join(';'),
  'the methods of lists': `${methods('Array.prototype', ['map', 'join', 'push', 'concat', 'slice', 'forEach'])}`,
  'lists without an iterator': 'delete Array.prototype[Symbol.iterator]',
  'iterators of lists': `Object.getPrototypeOf([][Symbol.iterator]()).next = () => ({ done: true })`,
  'functions of numbers and objects': [methods('Number', ['isFinite']), methods('Object', ['is', 'keys', 'entries', 'fromEntries', 'assign']), 'globalThis.String = globalThis.Number = () => "]"', methods('Reflect', ['apply'])].join(';'),
  'texts of numbers and texts': everywhere(`it.prototype.toString = it.prototype.valueOf = ${FORGED}`),
  'what is an error or a list': 'Array.isArray = () => false'
}

// The program ignores all results, because replaced built-ins may change them.
const USES = `
;{
  const tell = (value) => { try { echo(bot, value) } catch {} }
  const chest = bot.blockAt(new Vec3(1, 1, 1))
  bot.health
  bot.entity.position
  bot.chat('a "text" \\ud83d')
  bot.setControlState('jump', true)
  bot.pathfinder.thinkTimeout = 100
  bot.pathfinder.setGoal(new goals.GoalNear(1, 2.5, -0, 1))
  bot.pathfinder.setGoal(new goals.GoalInvert(new goals.GoalFollow(bot.entity, 2)))
  for (const value of { __proto__: null, *[Symbol.iterator] () { yield 1.5; yield -0; yield NaN; yield 1e21; yield null; yield undefined; yield true; yield 'x' } }) tell(value)
  tell({ key: { deep: [1, 'two', chest] }, place: new Vec3(1, 2, 3), own: bot, say: () => 1 })
  tell(new TypeError('wrong'))
  mcData.blocksByName.stone
  mcData.version
  const timer = setTimeout(() => {}, 5)
  clearTimeout(timer)
  setInterval(() => {}, 1e6)
  const listener = () => {}
  bot.on('health', listener)
  bot.once('chat', listener)
  bot.removeListener('health', listener)
  bot.findBlocks({ matching: () => true, maxDistance: 5 })
  bot.findBlocks({ matching: [1, 2], count: 3 })
  console.log('one', 2, 'two')
}
`

/** Return the messages of a program at the border, up to its end. @returns {Promise<string[]>} */
async function messagesOf (sandbox, code) {
  const { answer } = Session.prototype
  const messages = []
  Session.prototype.answer = function (text) {
    messages.push(text)
    return answer.call(this, text)
  }
  try {
    const bot = fakeBot()
    await sandbox.run({ code, bot, scope: fakeScope(bot) })
  } finally {
    Session.prototype.answer = answer
  }
  return messages
}

module.exports = { messagesOf, PATCHES, USES }
