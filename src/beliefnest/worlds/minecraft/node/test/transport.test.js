'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { connect, Mail } = require('../src/net/transport')
const { Translator } = require('../src/net/translate')
const { agentUuid } = require('../src/bots/bot')
const registry = require('prismarine-registry')('1.20.4')

const settled = () => new Promise(resolve => { setImmediate(resolve) })

function pair () {
  const faults = []
  const report = (fault, owner) => faults.push([owner, fault.message])
  const ends = connect({
    registry,
    mail: new Mail((owner, action) => { try { action() } catch (fault) { report(fault, owner) } }, report),
    translator: new Translator({ x: 160, z: 0 }),
    username: 'sally',
    agent: 'sally',
    uuid: agentUuid('sally'),
    readChat: content => content
  })
  return { ...ends, faults }
}

describe('a connection', () => {
  it('hands packets over in order, later, as they were when sent', async () => {
    const { client, server } = pair()
    const heard = []
    server.on('position', ({ x }) => heard.push(x))
    const packet = { x: 1, y: 0, z: 0 }
    client.write('position', packet)
    packet.x = 2
    client.write('position', packet)
    assert.deepEqual(heard, [])
    await settled()
    assert.deepEqual(heard, [161, 162])
  })

  it('tells both sides of its end once, and carries nothing after it', async () => {
    const { client, server } = pair()
    const heard = []
    client.on('end', () => heard.push('client'))
    server.on('end', () => heard.push('server'))
    server.on('flying', () => heard.push('packet'))
    client.write('flying', {})
    client.end()
    server.end()
    client.write('flying', {})
    await settled()
    assert.deepEqual(heard.sort(), ['client', 'server'])
  })

  it('reports what a handler throws, at once or later, and goes on', async () => {
    const { client, server, faults } = pair()
    server.on('one', () => { throw new Error('at once') })
    server.on('two', async () => { throw new Error('later') })
    const heard = []
    server.on('three', () => heard.push('three'))
    for (const name of ['one', 'two', 'three']) client.write(name, {})
    await settled()
    assert.deepEqual(faults, [['sally', 'at once'], ['sally', 'later']])
    assert.deepEqual(heard, ['three'])
  })
})

describe('a player id', () => {
  it('is the one Minecraft gives to that name offline', () => {
    assert.equal(agentUuid('Notch'), 'b50ad385-829d-3141-a216-7e7d7539ba7f')
  })
})
