'use strict'
const assert = require('node:assert/strict')
const { before, describe, it } = require('node:test')
const { Engine, GuestEnded } = require('../../src/sandbox/engine')
const { INITIAL_PAGES, interpreterBytes, STACK_BYTES } = require('../../src/sandbox/interpreter')
const { meter } = require('../../src/sandbox/meter')

const SCOPE = { parameters: [], skills: [], data: false }
const WORLD = { host: () => '{"ok":true,"value":null}', now: () => 0, random: () => 0 }
const LIMITS = { fuel: 10_000_000, memory: 64 * 2 ** 20 }

describe('the metered interpreter', () => {
  let engine
  before(() => { engine = new Engine() })

  /** Run a program of statements. Return the fuel used and the kind of its end. */
  async function run (statements, limits = LIMITS, world = WORLD) {
    const guest = await engine.open(limits, SCOPE)
    try {
      guest.start({ text: `(async function (marks) { ${statements} })`, marks: 1 }, world)
    } catch (error) {
      if (!(error instanceof GuestEnded)) throw error
      return { kind: error.kind, fuel: guest.fuelAtEnd, guest }
    }
    return { kind: null, fuel: guest.used, guest }
  }

  it('counts the same for the same program, whatever ran before', async () => {
    const code = 'const a = []; for (let i = 0; i < 500; i++) a.push({ i, s: "x".repeat(i) }); a.sort((x, y) => y.i - x.i); JSON.stringify(a)'
    const first = await run(code)
    await run('for (;;) {}')
    const second = await run(code)
    assert.equal(first.kind, null)
    assert.equal(second.fuel, first.fuel)
  })

  it('counts the same in an interpreter made beforehand, which is used once', async () => {
    const code = 'globalThis.left = (globalThis.left ?? 0) + 1; if (globalThis.left > 1) for (;;) {}'
    const first = await run(code)
    await engine.prepare()
    const { ready } = engine
    const second = await run(code)
    assert.equal(second.guest, ready.guest)
    assert.equal(second.fuel, first.fuel)
    assert.notEqual((await run(code)).guest, ready.guest)
    await engine.prepare()
    const other = await run(code, { ...LIMITS, fuel: LIMITS.fuel - 1 })
    assert.equal(other.guest.limits.fuel, LIMITS.fuel - 1)
    assert.equal(other.fuel, first.fuel)
  })

  it('counts more for more', async () => {
    const turns = async n => (await run(`for (let i = 0; i < ${n}; i++) {}`)).fuel
    const [few, many] = [await turns(1000), await turns(10_000)]
    assert.ok(many - few > 9000, `${few} ${many}`)
  })

  it('stops every kind of endless work', async () => {
    for (const code of ['for (;;) {}', 'for (;;) await null', 'Array.prototype.includes.call({ length: 2 ** 53 }, 1)', '/(x+x+)+y/.test("x".repeat(40))', '"x".repeat(1000000).split("").sort(() => 1)']) {
      assert.equal((await run(code)).kind, 'fuel', code)
    }
  })

  it('takes no more fuel than its limit and a known grace', async () => {
    const { fuel } = await run('Array.prototype.includes.call({ length: 2 ** 53 }, 1)')
    assert.ok(fuel <= LIMITS.fuel + 20_000_001, String(fuel))
  })

  it('charges copied memory', async () => {
    const fill = async bytes => (await run(`new Uint8Array(${bytes}).fill(1)`)).fuel
    assert.ok(await fill(8_000_000) - await fill(8000) > 8_000_000 / 64)
  })

  for (const [what, code] of [
    ['calls', 'function f() { f() } f()'],
    ['calls through the library', 'function f() { [1].forEach(f) } f()'],
    ['parsing', 'eval("(".repeat(100000))'],
    ['JSON', 'let a = []; for (let i = 0; i < 50000; i++) a = [a]; JSON.stringify(a)'],
    ['proxies', 'let p = {}; for (let i = 0; i < 50000; i++) p = new Proxy(p, {}); p.x'],
    ['flat', 'let a = []; for (let i = 0; i < 50000; i++) a = [a]; a.flat(Infinity)'],
    ['regular expressions', 'new RegExp("(?:".repeat(10000) + ")".repeat(10000))']
  ]) {
    it(`bounds the depth of ${what} before Node's stack is full`, async () => {
      const { guest } = await run(`try { ${code} } catch (error) {}`, { ...LIMITS, fuel: 100_000_000 })
      const { ended } = guest
      assert.ok(ended === null || (ended.kind === 'stack' && ended.message === 'trap'), String(ended))
      assert.ok(guest.interpreter.depth.value < STACK_BYTES * 1.1)
    })
  }

  it('allows a recursion of a thousand calls', async () => {
    assert.equal((await run('const f = (n) => n === 0 ? 0 : 1 + f(n - 1); if (f(1000) !== 1000) for (;;) {}')).kind, null)
  })

  it('holds the memory limit', async () => {
    const { kind, guest } = await run('const all = []; try { for (;;) all.push(new ArrayBuffer(1000000)) } catch (error) { if (all.length < 5 || all.length > 20) for (;;) {} }', { ...LIMITS, memory: 16 * 2 ** 20 })
    assert.equal(kind, null)
    assert.ok(guest.interpreter.glue.HEAPU8.length <= INITIAL_PAGES * 65536 + 16 * 2 ** 20)
  })

  it('runs nothing of a guest that has ended', async () => {
    const { guest } = await run('for (;;) {}')
    assert.throws(() => guest.send(['fire', 1]), GuestEnded)
  })

  it('hands texts over unharmed', async () => {
    const seen = []
    const world = { ...WORLD, host: text => { seen.push(JSON.parse(text)); return '{"ok":true,"value":null}' } }
    await run('console.log("a\\u0000b\\ud800c\\u{1f600}é")', LIMITS, world)
    assert.deepEqual(seen, [['log', 'log', 'a\u0000b\ud800c\u{1f600}é']])
  })

  it('makes the same module every time', () => {
    assert.deepEqual(interpreterBytes(), interpreterBytes())
  })
})

describe('the meter', () => {
  it('refuses what it does not know', () => {
    assert.throws(() => meter(Uint8Array.from([0, 97, 115, 109, 1, 0, 0, 0]), { stackBytes: 1, initialPages: 1 }), /has no type section/)
  })
})
