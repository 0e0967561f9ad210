'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR } = require('./harness')

const three = () => ({
  sally: agent([0.5, FLOOR, 0.5]), anne: agent([-4.5, FLOOR, 3.5], { inventory: { apple: 3 } }), bob: agent([4.5, FLOOR, 3.5])
})
const others = bot => Object.keys(bot.players).filter(name => name !== bot.username).sort()

test('all who are there know one another, names and bodies', async () => {
  await inWorld({ agents: three() }, async world => {
    await world.ticks(1)
    for (const [name, bot] of Object.entries(world.bots)) {
      assert.deepEqual(others(bot), Object.keys(world.bots).filter(other => other !== name).sort())
      for (const other of others(bot)) {
        assert.ok(bot.players[other].entity.position.distanceTo(world.bots[other].entity.position) < 0.01)
      }
    }
  })
})

test('whoever moves is seen to move by all, and only those who listen are told', async () => {
  await inWorld({ agents: three() }, async world => {
    const { bots: { sally, anne, bob }, players, at } = world
    const [moves, gone] = [[], sally.players.anne.entity]
    const listener = entity => moves.push([entity.username, entity.yaw, entity.position.x])
    bob.on('entityMoved', listener)
    await world.ticks(1)
    assert.deepEqual(moves, [])
    players.anne.place(at(2.25, FLOOR, 3.5), Math.PI / 2)
    assert.equal(gone.position.x, -4.5, 'a move is not seen before its packet has arrived')
    await world.ticks(1)
    // The turn of body and head, and then the way.
    assert.deepEqual(moves, [['anne', Math.PI / 2, -4.5], ['anne', Math.PI / 2, -4.5], ['anne', Math.PI / 2, 2.25]])
    for (const { players: { anne: { entity } } } of [sally, bob]) {
      assert.deepEqual([entity.position.toArray(), entity.yaw, entity.pitch, entity.headYaw], [[2.25, FLOOR, 3.5], Math.PI / 2, 0, Math.PI / 2])
    }
    assert.notEqual(sally.players.anne.entity, bob.players.anne.entity, 'only the pose is shared')
    assert.notEqual(anne.entity.position, gone.position)
    bob.removeListener('entityMoved', listener)
    players.sally.place(at(1.5, FLOOR, 0.5))
    await world.ticks(1)
    assert.deepEqual([moves.length, bob.players.sally.entity.position.x], [3, 1.5])
    world.regions.bodies.remove(world.region, 'anne')
    await world.regions.bodies.add(world.region, { anne: agent([-2.5, FLOOR, -2.5], { yaw: 1 }) })
    await world.ticks(1)
    assert.deepEqual([gone.isValid, gone.position.x, sally.players.anne.entity.position.x], [false, 2.25, -2.5])
  })
})

test('a quitter leaves the list, a joiner comes into it and is told who is there', async () => {
  await inWorld({ agents: three() }, async world => {
    const { bots: { sally }, regions, region } = world
    regions.bodies.remove(region, 'anne')
    await world.ticks(1)
    assert.deepEqual(others(sally), ['bob'])
    assert.equal(Object.values(sally.entities).filter(({ username }) => username === 'anne').length, 0)
    await regions.bodies.add(region, { carol: agent([2.5, FLOOR, 2.5]) })
    await world.ticks(1)
    assert.deepEqual(others(sally), ['bob', 'carol'])
    assert.equal(sally.players.carol.entity.position.x, 2.5)
    const { bot: carol } = region.bodies.get('carol')
    assert.deepEqual(others(carol), ['bob', 'sally'])
    assert.ok(carol.players.bob.entity)
  })
})

test('what somebody carried is there again after a lost connection, and forgotten when it is sent away', async () => {
  await inWorld({ agents: three() }, async world => {
    const { serv, players: { anne } } = world
    const start = { position: anne.position, yaw: 0, pitch: 0, onGround: true, health: 20, food: 20 }
    anne._client.end('lost')
    const back = serv.join(anne._client.peer.peer, start)
    back.emit('connected')
    assert.deepEqual(back.possessions().inventory, { apple: 3 })
    serv.forgetPlayer(back.uuid)
    const stranger = serv.join(anne._client, start)
    stranger.emit('connected')
    assert.deepEqual(stranger.possessions().inventory, {})
  })
})

test('whoever leaves with a window open takes along what the cursor carried', async () => {
  await inWorld({ agents: three(), blocks: [[-4, FLOOR, 5, 'chest']], containers: [[-4, FLOOR, 5, { diamond: 4 }]] }, async world => {
    const { bots: { anne }, players } = world
    await world.during(anne.openContainer(anne.blockAt(anne.entity.position.floored().offset(1, 0, 2))))
    await world.during(anne.clickWindow(0, 0, 0))
    await world.ticks(1)
    players.anne._client.end('lost')
    assert.deepEqual(players.anne.possessions().inventory, { apple: 3, diamond: 4 })
    await world.ticks(1)
    assert.deepEqual(world.events('get_item_from_chest').map(({ actor, detail }) => [actor, detail.items]), [['anne', { diamond: 4 }]])
  })
})

test('what plugins know of a place ends with it', async () => {
  await inWorld({ blocks: [[2, FLOOR, 0, 'chest'], [0, FLOOR, 3, 'stone_button', { face: 'floor' }]], containers: [[2, FLOOR, 0, { diamond: 1 }]] }, async world => {
    const { serv, bots: { sally } } = world
    await world.during(sally.activateBlock(sally.blockAt(sally.entity.position.floored().offset(0, 0, 3))))
    await world.ticks(1)
    serv.forgetRegion(() => true)
    assert.deepEqual([serv.containers.positions(() => true), world.container(2, FLOOR, 0)], [[], {}])
    await world.ticks(40)
    assert.equal(world.block(0, FLOOR, 3).properties.powered, true)
  })
})
