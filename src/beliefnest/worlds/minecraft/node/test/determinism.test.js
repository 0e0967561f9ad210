'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Worker } = require('node:worker_threads')
const { encode } = require('@msgpack/msgpack')
const { Node, region } = require('./harness')

const ROAM = `
  for (let i = 0; i < 6; i++) {
    const at = () => Math.floor(Math.random() * 20) - 9
    await bot.pathfinder.goto(new goals.GoalNear(at(), -51, at(), 1))
    bot.chat('at ' + bot.entity.position + ' ' + Date.now())
  }`

/** Return all frames of three roaming bots as bytes; `others` regions are made and used before. */
async function frames (others = []) {
  const node = new Node()
  try {
    await node.hello(7)
    for (const name of others) {
      await node.request('create_region', region(name))
      await node.request('run', { region: name, programs: { anne: ROAM }, timeout_ticks: 30 })
    }
    node.frames.length = 0
    const made = await node.request('create_region', region('roam'))
    const programs = { sally: ROAM, anne: ROAM, observer: ROAM }
    const run = await node.request('run', { region: 'roam', programs, timeout_ticks: 2000 })
    assert.ok(Object.values(run.results).every(result => result.ok), JSON.stringify(run.results))
    return Buffer.from(encode([made, run, node.frames]))
  } finally {
    await node.close()
  }
}

describe('the same seed', () => {
  it('gives the same frames, byte for byte, beside a busy processor and other regions', async () => {
    const first = await frames()
    assert.ok(first.length > 10000)
    const busy = new Worker('for (;;) {}', { eval: true })
    try {
      assert.ok(first.equals(await frames()), 'beside a busy processor')
    } finally {
      await busy.terminate()
    }
    assert.ok(first.equals(await frames(['before', 'between'])), 'beside other regions')
  })
})
