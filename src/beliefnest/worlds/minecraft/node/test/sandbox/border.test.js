'use strict'
/** Messages to the host of a program that has taken over the guest's side of the border. */
const assert = require('node:assert/strict')
const { beforeEach, describe, it } = require('node:test')
const { Session } = require('../../src/sandbox/session')
const { kinds } = require('../../src/sandbox/policy/kinds')
const { fakeBot, fakeScope } = require('./fake-world')

const BOT = { $: 'h', id: 0 }

/** Return a guest that accepts everything and answers every callback with undefined. */
const silentGuest = () => ({
  charge () {},
  start () {},
  result: () => null,
  idle: true,
  send: () => ({ ok: true, value: { now: { $: 'u' } } }),
  end () {}
})

describe('the border', () => {
  let bot
  let session
  beforeEach(() => {
    bot = fakeBot()
    const { mcData, ...skills } = fakeScope(bot)
    session = new Session(silentGuest(), { bot, skills, data: mcData, random: () => 0.5 })
    session.exchange.handle(bot, 'bot')
  })
  const ask = (...message) => JSON.parse(session.answer(JSON.stringify(message)))
  const refused = (message, reason) => {
    const { ok, value } = ask(...message)
    assert.equal(ok, false, JSON.stringify(value))
    assert.match(value.message, reason)
  }

  it('names only so many objects', () => {
    const left = 20_000 - session.exchange.objects.length
    for (let n = 0; n < left; n++) session.exchange.handle({}, 'block')
    assert.throws(() => session.exchange.handle({}, 'block'), /20000 game objects, which is the limit/)
    // One that has a name keeps it.
    assert.deepEqual(session.exchange.handle(bot, 'bot'), { $: 'h', id: 0, k: 'bot' })
  })

  it('answers what the guest asks', () => {
    assert.deepEqual(ask('get', BOT, 'health'), { ok: true, value: 20 })
  })

  for (const name of ['_client', 'quit', 'end', 'constructor', '__proto__', 'prototype', 'emit', 'on', 'loadPlugin', 'hasOwnProperty', 'toString']) {
    it(`gives no ${name}`, () => {
      refused(['get', BOT, name], /has no get/)
      refused(['set', BOT, name, 1], /has no set/)
      refused(['call', BOT, name, []], /has no call/)
      refused(['data', name, null], /no such table/)
      refused(['skill', name, []], /no such skill/)
      refused(['on', name, { $: 'f', id: 1 }, false], /cannot listen/)
      assert.deepEqual(ask('data', 'blocksByName', name), { ok: true, value: { $: 'u' } })
    })
  }

  it('takes no number of an object that was not handed out', () => {
    for (const id of [-1, 1, 0.5, 1e9, '0', null, '__proto__', 'length']) refused(['get', { $: 'h', id }, 'health'], /no object of the game/)
  })

  it('does not take an object of one kind for another', () => {
    ask('get', BOT, 'entity')
    refused(['call', BOT, 'closeWindow', [{ $: 'h', id: 1 }]], /must be window, found entity|not there/)
    refused(['get', { $: 'h', id: 1 }, 'health_'], /entity has no get/)
  })

  it('refuses actions, tags and forms it does not know', () => {
    for (const action of ['eval', '__proto__', 'constructor', 'toString', null, 7]) refused([action], /unknown form/)
    refused(['skill', 'echo', [BOT, { $: 'x' }]], /unknown form/)
    refused(['skill', 'echo', [BOT, { $: '__proto__' }]], /unknown form/)
    refused(['skill', 'echo', [BOT, {}]], /unknown form/)
    refused(['skill', 'echo', 7], /./)
    assert.equal(JSON.parse(session.answer('no JSON')).ok, false)
    assert.equal(JSON.parse(session.answer('null')).ok, false)
    assert.equal(JSON.parse(session.answer('x'.repeat(2_000_000))).ok, false)
    assert.equal(JSON.parse(session.answer('['.repeat(500_000) + ']'.repeat(500_000))).ok, false)
  })

  it('refuses keys that reach prototypes', () => {
    for (const key of ['__proto__', 'constructor', 'prototype']) refused(['skill', 'echo', [BOT, { $: 'o', o: [[key, 1]] }]], /is not allowed/)
    assert.equal({}.polluted, undefined)
  })

  it('refuses goals that are nested without end, and huge lists', () => {
    for (const depth of [11, 10_000]) {
      const goal = `${'{"$":"g","n":"GoalInvert","a":['.repeat(depth)}{"$":"g","n":"GoalY","a":[1]}${']}'.repeat(depth)}`
      const { ok, value } = JSON.parse(session.answer(`["skill", "echo", [${JSON.stringify(BOT)}, ${goal}]]`))
      assert.equal(ok, false)
      assert.match(value.message, /nested more than 10 deep/)
    }
    refused(['skill', 'echo', [BOT, new Array(20000).fill(0)]], /20000 elements/)
  })

  it('hands over nothing that is not data: functions, other bots, foreign objects', async () => {
    const other = fakeBot('anne')
    for (const value of [other, process, () => {}, new Map(), Buffer.alloc(3), globalThis, Symbol('x'), 1n]) {
      const answer = session.converted(true, () => session.exchange.toGuest({ value }, 'it'), 'test')
      assert.equal(answer[0], false, String(value))
    }
  })

  it('never says where the host\'s code is', async () => {
    session.skills.fail = () => { throw new Error('it failed') }
    const text = session.answer(JSON.stringify(['skill', 'fail', []]))
    assert.deepEqual(JSON.parse(text).value, { $: 'e', message: 'it failed', name: 'Error', skill: 'fail', kind: 'skill' })
  })

  it('takes no timer under a number that is taken, and stops every one at the end', (t) => {
    const started = []
    const stopped = []
    for (const what of ['Timeout', 'Interval']) {
      t.mock.method(globalThis, `set${what}`, () => started[started.push({}) - 1])
      t.mock.method(globalThis, `clear${what}`, (timer) => stopped.push(timer))
    }
    assert.equal(ask('timer', 7, 1e6, false).ok, true)
    for (const repeat of [true, false]) refused(['timer', 7, 1e6, repeat], /there is a timer 7 already/)
    for (const id of [null, '7', 7.5, [7], { id: 7 }, 2 ** 60]) refused(['timer', id, 1e6, true], /must be a whole number/)
    for (let id = 8; id < 1007; id++) assert.equal(ask('timer', id, 1e6, id % 2 === 0).ok, true)
    refused(['timer', 2000, 1e6, true], /1000 timers/)
    session.finish({ ok: true })
    assert.equal(started.length, 1000)
    assert.deepEqual(new Set(stopped), new Set(started))
  })

  it('says of what it refuses no more than what kind it is', () => {
    const deep = JSON.parse(`${'['.repeat(500)}${']'.repeat(500)}`)
    const long = 'x'.repeat(90_000)
    for (const message of [['get', BOT, deep], ['get', BOT, long], ['on', deep, 1, false], ['on', long, 1, false], [deep], [long],
      ['skill', 'echo', [BOT, { $: 'o', o: [[deep, 1]] }]], ['skill', 'echo', [BOT, { $: 'm', o: [[deep, 1]] }]],
      ['skill', 'echo', [BOT, { $: 'g', n: 'GoalPlaceBlock', a: [{ $: 'v', c: [1, 2, 3] }, { $: 'o', o: [['facing', long]] }] }]]]) {
      const { ok, value } = ask(...message)
      assert.equal(ok, false)
      assert.ok(value.message.length < 1000, value.message)
    }
    ask('log', deep, deep)
    assert.deepEqual(session.log, [{ level: 'something ', text: 'an array' }])
  })

  it('lets the program pay for goals that look along rays, and ends them with its fuel', () => {
    let fuel = 12_000
    session.guest.charge = (units) => (fuel -= units) > 0
    let looked = 0
    bot.world = { raycast: () => { looked++ } }
    ask('call', { $: 'h', id: session.exchange.handle(bot.pathfinder, 'pathfinder').id }, 'setGoal', [{ $: 'g', n: 'GoalLookAtBlock', a: [{ $: 'v', c: [1, 2, 3] }] }])
    const [[, goal]] = bot.calls
    fuel = 12_000
    const { Vec3 } = require('vec3')
    assert.equal(goal.isEnd(new Vec3(100, 2, 3)), false)
    assert.equal(fuel, 12_000)
    assert.equal(goal.isEnd(new Vec3(3, 2, 3)), false)
    assert.equal(goal.isEnd(new Vec3(3, 2, 3)), false)
    assert.ok(looked > 0)
    const before = looked
    assert.equal(goal.isEnd(new Vec3(3, 2, 3)), true)
    assert.equal(looked, before)
    assert.equal(session.outcome.ended.kind, 'fuel')
  })

  it('survives random messages', () => {
    let state = 12345
    const random = (below) => (state = (state * 1103515245 + 12345) % 2147483648) % below
    const members = Object.values(kinds).flatMap(({ get, set = {}, call }) => [...Object.keys(get), ...Object.keys(set), ...Object.keys(call)])
    const leaves = [null, true, -1, 1e308, 'x', '/op', { $: 'u' }, { $: 'n', v: 'NaN' }, { $: 'v', c: [1, 2, { $: 'n', v: 'Infinity' }] }, { $: 'v', c: [1, 2, 3] },
      BOT, { $: 'h', id: 1 }, { $: 'h', id: 2 }, { $: 'b', c: [1, 2, 3] }, { $: 'i', slot: 1, type: 7 }, { $: 'f', id: 1 }, { $: 'g', n: 'GoalNear', a: [1, 2, 3, 1] }, { $: 'm', o: [['canDig', 1]] }]
    const value = (depth) => depth > 2 || random(3) > 0 ? leaves[random(leaves.length)] : random(2) ? [value(depth + 1), value(depth + 1)] : { $: 'o', o: [[leaves[random(6)] ?? 'k', value(depth + 1)]] }
    const actions = ['get', 'set', 'call', 'skill', 'on', 'off', 'data', 'keys', 'state', 'settled', 'log']
    for (let turn = 0; turn < 5000; turn++) {
      const action = actions[random(actions.length)]
      const name = members[random(members.length)]
      const message = ['skill', 'data', 'keys'].includes(action) ? [action, name, [value(0)]] : [action, leaves[9 + random(9)], name, random(2) ? [value(0), value(0)] : value(0)]
      const { ok } = JSON.parse(session.answer(JSON.stringify(message)))
      assert.equal(typeof ok, 'boolean')
    }
    for (const forbidden of ['write', 'end', 'quit', 'loadPlugin']) assert.ok(!bot.calls.some(([call]) => call === forbidden))
    assert.ok(!bot.calls.some(([call, text]) => call === 'chat' && String(text).startsWith('/')))
    session.finish({ ok: true })
  })
})
