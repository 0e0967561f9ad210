'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Node, region } = require('./harness')

const ROAM = `
  for (let i = 0; i < 2; i++) {
    const at = () => Math.floor(Math.random() * 20) - 9
    await bot.pathfinder.goto(new goals.GoalNear(at(), -51, at(), 1))
    bot.chat('at ' + bot.entity.position + ' ' + Date.now())
  }`
// Ends in the middle of a step, with speed left.
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
