'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { agent, Node, region } = require('./harness')

const ROAM = `
  for (let i = 0; i < 2; i++) {
    const at = () => Math.floor(Math.random() * 20) - 9
    await bot.pathfinder.goto(new goals.GoalNear(at(), -51, at(), 1))
    bot.chat('at ' + bot.entity.position + ' ' + Date.now())
  }`
// This program ends in the middle of a step, while the body still moves.
const RUSH = "bot.setControlState('sprint', true); bot.setControlState('forward', true); await bot.waitForTicks(13)"
const run = (node, code) => node.request('run', {
  region: 'roam', programs: { sally: code, anne: ROAM, observer: ROAM }, timeout_ticks: 2000
})

describe('a region made from a snapshot', () => {
  it('goes on as the one the snapshot was taken of', async () => {
    const [one, two] = [new Node(), new Node()]
    try {
      await one.hello(7)
      await one.request('create_region', region('roam'))
      await run(one, RUSH)
      await run(one, RUSH)
      const snapshot = await one.request('snapshot', { region: 'roam' })
      await two.hello(7)
      await two.request('create_region', region('roam', snapshot))
      one.frames.length = 0
      for (const code of [ROAM, RUSH, ROAM]) {
        assert.deepEqual(await run(two, code), await run(one, code))
        assert.deepEqual(two.frames, one.frames)
      }
      assert.ok(one.frames.length > 100)
    } finally {
      await one.close()
      await two.close()
    }
  })

  it('draws other random numbers at every tick', async () => {
    const node = new Node()
    try {
      await node.hello()
      await node.request('create_region', region('roam'))
      const draw = 'bot.chat(String(Math.random())); await bot.waitForTicks(1); bot.chat(String(Math.random()))'
      for (let count = 0; count < 3; count++) {
        await node.request('run', { region: 'roam', programs: { sally: draw }, timeout_ticks: 20 })
      }
      const said = node.frames.flatMap(({ events }) => events).filter(({ kind }) => kind === 'chat')
      assert.equal(new Set(said.map(({ detail }) => detail.text)).size, 6)
    } finally {
      await node.close()
    }
  })
})

describe('dropped items', () => {
  const toss = yaw => `await bot.look(${yaw}, 0.5, true); await bot.toss(mcData.itemsByName.dirt.id, null, 1); await bot.waitForTicks(30)`
  const rich = () => region('roam', { agents: { sally: agent([0.5, -51, 0.5], { inventory: { dirt: 9 } }), anne: agent([8.5, -51, 8.5]) } })
  const drop = (node, yaw) => node.request('run', { region: 'roam', programs: { sally: toss(yaw) }, timeout_ticks: 200 })

  it('keep their numbers in a region made from a snapshot, and new ones get the same', async () => {
    const [one, two] = [new Node(), new Node()]
    try {
      for (const node of [one, two]) await node.hello()
      await one.request('create_region', rich())
      await drop(one, 0)
      const snapshot = await one.request('snapshot', { region: 'roam' })
      const made = await two.request('create_region', { ...rich(), ...snapshot })
      assert.deepEqual(made, snapshot)
      one.frames.length = 0
      assert.deepEqual(await drop(two, 3), await drop(one, 3))
      assert.deepEqual(two.frames, one.frames)
      const numbers = new Set(two.frames.flatMap(({ items }) => Object.keys(items)))
      assert.equal([...numbers].filter(number => !(number in snapshot.items)).length, 1, 'a number of its own')
    } finally {
      await one.close()
      await two.close()
    }
  })

  it('are made as asked by their numbers', async () => {
    const node = new Node()
    try {
      await node.hello()
      await node.request('create_region', rich())
      await drop(node, 0)
      const { items } = await node.request('snapshot', { region: 'roam' })
      const [[number, lying]] = Object.entries(items)
      const other = { name: 'stone', count: 2, position: [3.5, -51, 3.5] }
      const apply = wanted => node.request('apply', { region: 'roam', tick: 90, blocks: [], containers: [], agents: {}, items: wanted })
      assert.deepEqual((await apply({ [number]: lying, 70000: other })).items, { [number]: lying, 70000: other })
      assert.deepEqual((await apply({ 70000: other })).items, { 70000: other })
      await assert.rejects(apply({ 1: other }), { kind: 'bad_request', message: /number of an agent/ })
    } finally {
      await node.close()
    }
  })
})
