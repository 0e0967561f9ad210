'use strict'
/** Programs that try to do harm. Each must end with a clear error, and the next program must run normally. */
const assert = require('node:assert')
const { before, beforeEach, describe, it } = require('node:test')
const { createSandbox } = require('../../src/sandbox')
const { fakeBot, fakeScope } = require('./fake-world')

const FUEL = 15_000_000

// Each: name, program, kind of the error, pattern of its message.
const HARM = [
  ['an endless loop', 'while (true) {}', 'fuel', /fuel exhausted.*15000000/],
  ['an endless loop after an await', 'await null\nfor (;;) {}', 'fuel', /fuel exhausted/],
  ['endless awaits', 'while (true) await null', 'fuel', /fuel exhausted/],
  ['an endless chain of promises', 'const again = () => Promise.resolve().then(again); await again()', null, /fuel exhausted|memory exhausted/],
  ['endless jobs of promises', 'const again = () => { Promise.resolve().then(again) }; again(); await new Promise(() => {})', 'fuel', /fuel exhausted/],
  ['an endless loop in a timer', 'setTimeout(() => { for (;;) {} }, 0); await bot.waitForTicks(1000)', 'fuel', /fuel exhausted/],
  ['an endless loop in a listener', 'bot.on("health", () => { for (;;) {} }); await emit("health")', 'fuel', /fuel exhausted/],
  ['a long result of a callback', "await exploreUntil(bot, new Vec3(1, 0, 0), 3, () => '€'.repeat(1.4e6))", 'skill', /more than 1000000 characters/],
  ['an endless loop in a callback', 'await exploreUntil(bot, new Vec3(1, 0, 0), 3, () => { for (;;) {} })', 'fuel', /fuel exhausted/],
  ['an endless loop in a matcher', 'bot.findBlocks({ matching: () => { for (;;) {} } })', 'fuel', /fuel exhausted/],
  ['an endless loop in a getter', 'await echo(bot, { get x() { for (;;) {} } })', 'fuel', /fuel exhausted/],
  ['an endless loop that catches', 'for (;;) { try { for (;;) {} } catch {} finally { continue } }', 'fuel', /fuel exhausted/],
  ['an endless loop of calls', 'for (;;) bot.health', 'fuel', /fuel exhausted/],
  ['an endless generator', 'function* all() { for (;;) yield 1 }\nfor (const x of all()) x', 'fuel', /fuel exhausted/],
  ['an endless loop inside the library', 'Array.prototype.indexOf.call({ length: 2 ** 53 }, 1)', 'fuel', /fuel exhausted/],
  ['a search in a sparse array', 'new Array(4294967295).lastIndexOf(1)', 'fuel', /fuel exhausted/],
  ['a regular expression bomb', '/(a+)+$/.test("a".repeat(50) + "b")', 'fuel', /fuel exhausted/],
  ['huge integers', 'let x = 3n; for (;;) x = x * x', null, /exhausted|too large/],
  ['a sort with a liar', 'new Array(100000).fill(0).sort(() => Math.random() - 0.5); for (;;) {}', 'fuel', /fuel exhausted/],
  ['a proxy of endless keys', 'for (const key in new Proxy({}, { ownKeys: () => { for (;;) {} } })) key', 'fuel', /fuel exhausted/],
  ['a memory bomb', 'const all = []; for (;;) all.push(new Array(10000).fill(1))', null, /exhausted/],
  ['a memory bomb that catches', 'const all = []; for (;;) { try { all.push(new Array(10000).fill(1)) } catch (e) { all.push(e) } }', null, /memory exhausted|fuel exhausted/],
  ['a string bomb', 'let s = "x"; for (;;) s += s', null, /exhausted|too long/],
  ['an array buffer bomb', 'const all = []; for (;;) all.push(new ArrayBuffer(1e7))', null, /memory exhausted|fuel exhausted|buffer/],
  ['a huge array buffer', 'new ArrayBuffer(2 ** 40)', 'error', /buffer/],
  ['deep recursion', 'function f() { return f() + 1 }\nf()', 'stack', /stack overflow/],
  ['deep recursion through the library', 'function f() { return [1].map(f) }\nf()', 'stack', /stack overflow/],
  ['deep recursion through the host', 'const f = () => bot.findBlocks({ matching: f }); f()', null, /stack overflow|refused|exhausted/],
  ['deep recursion of getters', 'const o = { get x() { return this.x } }; o.x', 'stack', /stack overflow/],
  ['deep recursion of toString', 'const o = {}; o.toString = () => `${o}`; String(o)', 'stack', /stack overflow/],
  ['deeply nested data for JSON', 'let a = []; for (let i = 0; i < 1e5; i++) a = [a]; JSON.stringify(a)', 'stack', /stack overflow/],
  ['deeply nested code', `eval("[".repeat(100000))`, null, /stack overflow|nested/],
  ['deeply nested data for the host', 'let a = []; for (let i = 0; i < 100; i++) a = [a]; await echo(bot, a)', 'error', /nested more than 32 deep/],
  ['cyclic data for the host', 'const a = {}; a.a = a; await echo(bot, a)', 'error', /nested more than 32 deep/],
  ['process.exit', 'process.exit(1)', 'error', /'process' is not defined/],
  ['require', 'require("fs")', 'error', /'require' is not defined/],
  ['a dynamic import', 'await import("fs")', 'syntax', /import is not available/],
  ['a dynamic import in eval', 'await eval("import(\'fs\')")', 'error', /could not load module/],
  ['an import declaration', 'import fs from "fs"', 'syntax', /import/],
  ['a thrown text', 'throw "plain text"', 'error', /the program threw plain text/],
  ['a thrown null', 'throw null', 'error', /the program threw null/],
  ['a thrown undefined later', 'await null\nthrow undefined', 'error', /the program threw undefined/],
  ['a thrown symbol', 'throw Symbol("s")', 'error', /the program threw Symbol\(s\)/],
  ['an error that lies', 'throw Object.assign(new Error("x"), { stack: { toString() { for (;;) {} } }, name: 7 })', null, /x|exhausted/],
  ['an error whose message is a trap', 'throw Object.defineProperty(new Error(), "message", { get() { throw 1 } })', null, /./],
  ['a rejection', 'await Promise.reject(new TypeError("no"))', 'error', /TypeError: no/],
  ['a syntax error', 'let a = ;', 'syntax', /Unexpected token/],
  ['a program that closes its wrapper', '}); for (;;) {} (function () {', 'syntax', /Unexpected token/],
  ['a command by chat', 'bot.chat("/op sally")', 'refused', /is a command/],
  ['a whisper as a command', 'bot.chat("/tell anne hello")', 'refused', /is a command/],
  ['a command behind spaces', 'bot.chat("  /op sally")', 'refused', /is a command/],
  ['a command in a second line', 'bot.chat("hello\\n/op sally")', 'refused', /must be one line/],
  ['a command through a whispered name', 'bot.whisper("x\\n/op", "y")', 'refused', /name of an agent/],
  ['10 MB of chat', 'bot.chat("x".repeat(1e7))', null, /more than 1000000 characters|exhausted/],
  ['10 MB of chat in pieces', 'for (let i = 0; i < 1e7 / 250; i++) bot.chat("x".repeat(250))', 'fuel', /fuel exhausted/],
  ['chat of an object', 'bot.chat({ toString: () => "/op" })', 'refused', /must be a text/],
  ['quitting', 'bot.quit()', 'error', /bot.quit is not a function/],
  ['ending', 'bot.end()', 'error', /bot.end is not a function/],
  ['writing packets', 'bot._client.write("chat", {})', 'error', /TypeError/],
  ['loading a plugin', 'bot.loadPlugin(() => {})', 'error', /not a function/],
  ['emitting events', 'bot.emit("end")', 'error', /not a function/],
  ['an internal event', 'bot.on("inject_allowed", () => {})', 'refused', /cannot listen/],
  ['an event of the prototype', 'bot.on("constructor", () => {})', 'refused', /cannot listen/],
  ['a coordinate that is NaN', 'await goToPosition(bot, new Vec3(NaN, 1, 2))', 'refused', /argument 2 of goToPosition.x must be a finite number, found NaN/],
  ['an infinite coordinate', 'bot.blockAt(new Vec3(0, Infinity, 0))', 'refused', /bot.blockAt.y must be a finite number, found Infinity/],
  ['a coordinate outside the world', 'bot.blockAt(new Vec3(0, 1e300, 0))', 'refused', /outside the world/],
  ['a goal that is NaN', 'await bot.pathfinder.goto(new goals.GoalNear(0, NaN, 0, 1))', null, /argument 2 of GoalNear must be a finite number/],
  ['an infinite distance', 'bot.findBlocks({ matching: 1, maxDistance: Infinity })', 'refused', /maxDistance must be a finite number/],
  ['a huge distance', 'bot.findBlocks({ matching: 1, maxDistance: 1e9 })', 'refused', /between 0 and 128/],
  ['a time that is NaN', 'bot.waitForTicks(NaN)', 'refused', /must be a finite number/],
  ['half an item', 'await (await bot.openContainer(bot.blockAt(new Vec3(0, 1, 0)))).deposit(7, null, 0.5)', null, /whole number, found 0.5|is not there/],
  ['too many calls at once', 'for (let i = 0; i < 1000; i++) never()', 'refused', /calls are under way/],
  ['too many timers', 'for (let i = 0; i < 5000; i++) setTimeout(() => {}, 1e6)', 'refused', /1000 timers/],
  ['too many listeners', 'for (let i = 0; i < 5000; i++) bot.on("health", () => {})', 'refused', /100 listeners/],
  ['a forbidden key', 'await echo(bot, JSON.parse(\'{"__proto__": {"x": 1}}\'))', 'refused', /the key __proto__/],
  ['a constructor key', 'await echo(bot, { constructor: { prototype: 1 } })', 'refused', /the key constructor/],
  ['a promise as an argument', 'await goToPosition(bot, Promise.resolve(1))', null, /await is missing/],
  ['a bigint as an argument', 'await echo(bot, 1n)', 'error', /bigint cannot be handed out/],
  ['a symbol as an argument', 'await echo(bot, Symbol("x"))', 'error', /symbol cannot be handed out/],
  ['a proxy as an argument', 'await goToPosition(bot, new Proxy({}, { get: (_, key) => key === "x" ? 1 : undefined }))', null, /offset|must be|y/],
  ['a broken library', 'delete Array.prototype[Symbol.iterator]; const [one] = await echo(bot, [1])', 'error', /not iterable/],
  ['an error of the program itself, with a stack of 10^5 lines', 'const e = new Error("mine"); e.stack = "    at x (program.js:1:9)\\n".repeat(1e5); throw e', 'error', /^mine$/],
  ['an error with a name without end', 'const e = new Error("mine"); e.name = "x".repeat(1e6); throw e', 'error', /mine/],
  ['more lines than a program may have', '0\n'.repeat(20000), 'syntax', /20001 lines, the limit is 2000/],
  ['goals without end', 'await bot.pathfinder.goto(new goals.GoalCompositeAny(Array.from({ length: 2 }, () => new goals.GoalCompositeAny(Array(60).fill(new goals.GoalLookAtBlock(new Vec3(5, 1, 5), bot.world))))))', null, /more than 100 goals in one/],
  ['a goal that looks far', 'await bot.pathfinder.goto(new goals.GoalLookAtBlock(new Vec3(5, 1, 5), bot.world, { reach: 256 }))', null, /reach of GoalLookAtBlock must be between 0 and 8, found 256/],
  ['a rejection that nobody waits for', 'Promise.reject(new Error("mine")); await bot.waitForTicks(5)', 'error', /^mine \(nothing waited for/],
  ['a rejection of null that nobody waits for', 'Promise.reject(null)', 'error', /the program threw null/],
  ['rejections without end', 'for (;;) Promise.reject(1)', null, /fuel|memory/],
  ['handled rejections without end', 'for (;;) Promise.reject(1).catch(() => {})', null, /fuel|memory/],
  ['a rejection in a microtask', 'queueMicrotask(() => { throw new Error("micro") }); await bot.waitForTicks(5)', 'error', /micro/],
  ['a promise that nothing settles', 'await new Promise(() => {})', 'stuck', /nothing will settle/],
  ['an object made like the bot', 'Object.create(Object.getPrototypeOf(bot)).chat("x")', 'error', /no object of the game/],
  ['a method of the bot on something else', 'bot.chat.call({}, "x")', 'error', /no object of the game/]
]

describe('a hostile program', () => {
  let sandbox
  let bot
  let scope
  before(() => { sandbox = createSandbox({ fuel: FUEL }) })
  beforeEach(() => {
    bot = fakeBot()
    scope = { ...fakeScope(bot), emit: async (event) => { bot.emit(event) } }
  })

  async function assertNextIsNormal () {
    const other = fakeBot('anne')
    const code = 'const p = await goToPosition(bot, new Vec3(1, 2, 3)); bot.chat("fine " + p.plus(new Vec3(0, 1, 0)) + [3, 1, 2].sort() + JSON.stringify({ a: 1 }))'
    const { ok, error } = await sandbox.run({ code, bot: other, scope: fakeScope(other) })
    assert.strictEqual(ok, true, error?.message)
    assert.deepStrictEqual(other.calls.at(-1), ['chat', 'fine (1, 4, 3)1,2,3{"a":1}'])
  }

  for (const [name, code, kind, message] of HARM) {
    it(`ends: ${name}`, async () => {
      const { ok, error } = await sandbox.run({ code, bot, scope })
      const before = bot.calls.length
      if (ok) assert.fail(`ended well, with ${JSON.stringify(bot.calls)}`)
      assert.match(error.message, message)
      if (kind !== null) assert.strictEqual(error.kind, kind, error.message)
      assert.ok(['fuel', 'memory', 'stack', 'stuck', 'error', 'refused', 'skill', 'syntax'].includes(error.kind), error.kind)
      assert.ok(error.message.length <= 4000)
      for (const forbidden of ['write', 'end', 'quit', 'loadPlugin']) assert.ok(!bot.calls.some(([call]) => call === forbidden))
      await assertNextIsNormal()
      assert.strictEqual(bot.eventNames().length, 0)
      assert.strictEqual(bot.calls.length, before)
    })
  }

  it('cannot run on after its end', async () => {
    const code = `
      setTimeout(() => bot.chat('late timer'), 0)
      setInterval(() => bot.chat('late interval'), 1)
      bot.on('health', () => bot.chat('late listener'))
      bot.waitForTicks(1).then(() => bot.chat('late promise'))
      bot.waitForTicks(2).then(() => { throw new Error('late rejection') })
      Promise.resolve().then(async () => { for (let i = 0; i < 20; i++) { await null; bot.chat('late job') } })`
    const { ok } = await sandbox.run({ code, bot, scope })
    assert.strictEqual(ok, true)
    const count = bot.calls.length
    bot.emit('health')
    await new Promise((resolve) => { setTimeout(resolve, 5) })
    assert.strictEqual(bot.calls.length, count)
    await assertNextIsNormal()
  })

  it('cannot change what later programs see', async () => {
    const code = `
      for (const object of [Object, Array, Promise, Function, String, Vec3, Map, Error, JSON, Math, goals.GoalNear]) {
        for (const name of Object.getOwnPropertyNames(object.prototype ?? object)) try { (object.prototype ?? object)[name] = () => 'mine' } catch {}
      }
      goToPosition = () => 'mine'
      globalThis.goToPosition = globalThis.bot = globalThis.Vec3 = 'mine'`
    await sandbox.run({ code, bot, scope })
    await assertNextIsNormal()
  })
})
