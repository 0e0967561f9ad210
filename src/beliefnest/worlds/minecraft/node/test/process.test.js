'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Node, region } = require('./harness')

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
    await assert.rejects(node.request('hello', { protocol: 6, seed: 0, minecraft: '1.8' }), refused(/1\.8/))
    await node.hello()
    await assert.rejects(node.request('dance'), refused(/dance/))
    await node.close()
  })
})
