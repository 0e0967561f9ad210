'use strict'
/**
 * The behaviour of an agent's body after the end of its program does not depend on other agents' programs. Effects of
 * time itself are left out, such as somebody picking up an item at its feet.
 */
const assert = require('node:assert/strict')
const { after, before, describe, it } = require('node:test')
const { Random } = require('../src/time/random')
const { agent, floor, Node, region, STONE } = require('./harness')

const CASES = process.env.BELIEFNEST_NIGHTLY === '1' ? 250 : 12
const IDLE = 'return'
const WAITS = 'await bot.waitForTicks(60)'
const UNFINISHED = 'bot.equip(mcData.itemsByName.dirt.id, "hand"); bot.dig(bot.blockAt(new Vec3(0, -51, 2)))'

const STEPS = [
  random => `bot.look(${(random.next() * 6).toFixed(2)}, ${(random.next() - 0.5).toFixed(2)})`,
  random => `bot.setControlState('${pick(random, ['forward', 'back', 'left', 'sprint', 'sneak'])}', true)`,
  () => "bot.setControlState('jump', true)",
  random => `await bot.waitForTicks(${1 + Math.floor(random.next() * 9)})`,
  random => `goToPosition(bot, new Vec3(${Math.floor(random.next() * 8)}, -51, ${Math.floor(random.next() * 8)}), 1)`,
  random => `bot.equip(mcData.itemsByName.${pick(random, ['dirt', 'stick'])}.id, "${pick(random, ['hand', 'off-hand'])}")`,
  () => 'bot.dig(bot.blockAt(new Vec3(0, -51, 2)))',
  () => 'await bot.openContainer(bot.blockAt(new Vec3(2, -51, 0)))'
]

function pick (random, list) {
  return list[Math.floor(random.next() * list.length)]
}

function programs (seed) {
  const random = new Random(seed)
  const one = () => Array.from({ length: 1 + Math.floor(random.next() * 5) }, () => pick(random, STEPS)(random)).join('\n')
  return [one(), one(), one()]
}

const AGENTS = () => ({
  ann: agent([0.5, -51, 0.5], { inventory: { dirt: 20, stick: 5 } }),
  bob: agent([-8.5, -51, -8.5])
})

describe('the body of an agent whose program has ended', () => {
  const node = new Node()
  before(() => node.hello(7))
  after(() => node.close())

  /** Return AGENT of Ann after each of her programs, and her reports. @returns {Promise<object[]>} */
  async function annBeside (bob, anns, name) {
    const blocks = floor([[0, -51, 2, STONE], [2, -51, 0, 2955]])
    await node.request('create_region', region(name, { seed: 'one', blocks, agents: AGENTS() }))
    const states = []
    for (const ann of anns) {
      const { results } = await node.request('run', { region: name, programs: { ann, bob }, timeout_ticks: 400 })
      const { agents } = await node.request('snapshot', { region: name })
      states.push({ state: agents.ann, ticks: results.ann.ticks, ok: results.ann.ok, unfinished: results.ann.unfinished })
    }
    await node.request('destroy_region', { region: name })
    return states
  }

  async function same (anns, name) {
    const idle = await annBeside(IDLE, anns, `${name} idle`)
    assert.deepEqual(await annBeside(WAITS, anns, `${name} waits`), idle, anns.join('\n---\n'))
    return idle
  }

  it('does not go on turning its head', () => same(['bot.look(3, 0.5); await bot.waitForTicks(1)', IDLE], 'head'))

  it('does not go on sliding', () => same(["bot.setControlState('sprint', true); bot.setControlState('forward', true); await bot.waitForTicks(9)", IDLE], 'slide'))

  it('comes down from a jump', async () => {
    const jump = "bot.setControlState('jump', true); bot.setControlState('forward', true); await bot.waitForTicks(4)"
    const [{ state, ticks }] = await same([jump, IDLE], 'jump')
    assert.equal(state.position[1], -51)
    assert.equal(state.on_ground, true)
    assert.ok(ticks < 6, 'its program had ended before')
  })

  it('does no more of what was not waited for', async () => {
    const [{ unfinished }] = await same([UNFINISHED, IDLE], 'unfinished')
    assert.ok(unfinished.length > 0)
  })

  for (let seed = 0; seed < CASES; seed++) {
    it(`ends as it does beside an idle one, example ${seed}`, () => same(programs(`rest ${seed}`), `example ${seed}`))
  }
})
