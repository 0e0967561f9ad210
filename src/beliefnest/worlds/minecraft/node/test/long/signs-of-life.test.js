'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { agent, BOX, Node, region } = require('../harness')

describe('the process', () => {
  it('tells that it lives while a program computes within one tick, and while quiet ticks pass', async () => {
    const node = new Node()
    await node.hello()
    // Enough agents to compute for more than a second on any machine.
    const names = Array.from({ length: 8 }, (_, number) => `agent${number}`)
    const agents = Object.fromEntries(names.map((name, number) => [name, agent([number - 3.5, BOX[0][1] + 1, 0.5])]))
    const { tick } = await node.request('create_region', region('busy', { agents }))
    const busy = Object.fromEntries(names.map(name => [name, 'for (;;) {}']))
    await node.request('run', { region: 'busy', programs: busy, timeout_ticks: 10 })
    assert.equal(node.beats[0], tick)
    node.beats.length = 0
    let ticks = tick + 1
    // On any machine, some number of ticks takes longer than Node may be silent.
    for (let span = 4000; node.beats.length === 0; span *= 2) {
      await node.request('step', { region: 'busy', ticks: span })
      ticks += span
    }
    assert.ok(node.beats[0] > tick && node.beats[0] <= ticks, `${node.beats[0]}`)
    await node.close()
  })
})
