'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { agent, BOX, Node, region } = require('./harness')

describe('the process', () => {
  it('ends when its lifeline is cut, however busy it is', async () => {
    const node = new Node()
    await node.hello()
    await node.request('create_region', region('busy'))
    // Never answered: an endless loop blocks the main thread.
    node.request('run', { region: 'busy', programs: { sally: 'for (;;) {}' }, timeout_ticks: 10 }).catch(() => {})
    node.child.stdio[4].destroy()
    assert.deepEqual(await node.exited, { code: null, signal: 'SIGKILL' })
  })

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

  it('ends when the channel is closed', async () => {
    const node = new Node()
    await node.hello()
    node.child.stdio[3].destroy()
    assert.deepEqual(await node.exited, { code: 0, signal: null })
  })

  it('ends after shutdown', async () => {
    const node = new Node()
    await node.hello()
    assert.equal(await node.request('shutdown'), null)
    assert.deepEqual(await node.exited, { code: 0, signal: null })
  })

  it('refuses another protocol, another version, and work before hello', async () => {
    const node = new Node()
    const refused = message => ({ kind: 'bad_request', message })
    await assert.rejects(node.request('step', { region: 'a', ticks: 1 }), refused(/hello/))
    await assert.rejects(node.request('hello', { protocol: 9, seed: 0, minecraft: '1.20.4' }), refused(/protocol 9/))
    await assert.rejects(node.request('hello', { protocol: 3, seed: 0, minecraft: '1.8' }), refused(/1\.8/))
    await node.hello()
    await assert.rejects(node.request('dance'), refused(/dance/))
    await node.close()
  })
})
