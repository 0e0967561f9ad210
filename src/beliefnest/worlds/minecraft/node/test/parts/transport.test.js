'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { Appearance } = require('../../src/net/appearance')
const { connect, Mail, ServerEnd } = require('../../src/net/transport')
const { Translator } = require('../../src/net/translate')
const { agentUuid } = require('../../src/bots/bot')
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

describe('the mail of a region', () => {
  function three () {
    const mail = new Mail((_, action) => action(), () => {})
    const heard = []
    const ends = ['anne', 'bob', 'sally'].map(name => {
      const { client, server } = connect({
        registry, mail, translator: new Translator({ x: 160, z: 0 }), username: name, agent: name, uuid: agentUuid(name), readChat: content => content
      })
      for (const packet of ['entity_teleport', 'collect']) client.on(packet, params => heard.push([name, packet, params]))
      return { client, server }
    })
    return { mail, heard, ends, clients: ends.map(({ client }) => client), servers: ends.map(({ server }) => server) }
  }

  it('brings one translated packet to several players, in order', async () => {
    const { heard, servers: [anne, bob, sally] } = three()
    ServerEnd.writeToAll([anne, bob], 'entity_teleport', { entityId: 3, x: 161, y: 0, z: 0 })
    bob.write('collect', { entityId: 4 })
    anne.end('left')
    ServerEnd.writeToAll([anne, sally], 'collect', { entityId: 5 })
    await settled()
    assert.deepEqual(heard.map(([name, packet, { entityId, x }]) => [name, packet, entityId, x]),
      [['bob', 'entity_teleport', 3, 1], ['bob', 'collect', 4, undefined], ['sally', 'collect', 5, undefined]])
  })

  it('changes the appearance of who moves when the packet arrives, and tells only those who watch, first who joined first', async () => {
    const { mail, heard, clients: [anne, bob, sally] } = three()
    const appearance = new Appearance()
    const move = x => mail.postMove(appearance, anne, 'entity_teleport', { x, y: 2, z: 3, yaw: 64, pitch: 0 })
    for (const client of [sally, bob, anne]) client.watch(true)
    move(7)
    assert.equal(appearance.position.x, 0)
    await settled()
    assert.deepEqual([appearance.position.toArray(), appearance.yaw], [[7, 2, 3], Math.PI / 2])
    assert.deepEqual(heard.map(([name, , { x }]) => [name, x]), [['bob', 7], ['sally', 7]])
    bob.watch(false)
    sally.end('left')
    move(8)
    await settled()
    assert.deepEqual([appearance.position.x, heard.length], [8, 2])
  })
})

describe('a player id', () => {
  it('is the one Minecraft gives to that name offline', () => {
    assert.equal(agentUuid('Notch'), 'b50ad385-829d-3141-a216-7e7d7539ba7f')
  })
})
