'use strict'
const assert = require('node:assert/strict')
const { after, before, describe, it } = require('node:test')
const { Box, runsOf } = require('../src/regions/box')
const { agent, BOX, floor, Node, region, STONE } = require('./harness')

const AIR = 0
const GLASS = 519
const CHEST = 2955
const WALK = "await bot.pathfinder.goto(new goals.GoalNear(5, -51, 5, 1))"

describe('regions', () => {
  let node
  before(async () => {
    node = new Node()
    await node.hello()
  })
  after(() => node.close())

  it('stand as asked, to the last digit', async () => {
    const agents = {
      sally: agent([0.123456, -51, 0.5], { yaw: 1.234567, pitch: -0.5 }),
      anne: agent([3.5, -51, -2.5], { yaw: -3, inventory: { iron_chestplate: 1, dirt: 70 }, equipment: { main_hand: 'iron_chestplate' } })
    }
    const snapshot = await node.request('create_region', region('exact', { agents }))
    assert.deepEqual(snapshot.agents.sally, agents.sally)
    assert.deepEqual(snapshot.agents.anne, { ...agents.anne, inventory: { dirt: 70, iron_chestplate: 1 } })
    assert.deepEqual(snapshot.changes, [], 'the blocks are as asked')
    await node.request('step', { region: 'exact', ticks: 40 })
    assert.deepEqual(node.frames, [], 'agents who stand still make no frames')
  })

  it('have containers where they stand', async () => {
    const box = new Box([-20, -60, -5], [13, -30, 30])
    const states = new Int32Array(box.size)
    box.forEach((x, y, z, index) => {
      if (y === -60) states[index] = STONE
      else if (y < -30 && (x * 7 + y * 3 + z) % 11 === 0) states[index] = [STONE, GLASS, 79][(x + y + z) & 1]
    })
    const [chest, corner] = [[3, -40, 9], [13, -30, 30]]
    for (const place of [chest, corner]) states[box.index(...place)] = CHEST
    const made = await node.request('create_region', region('sections', { box: [box.low, box.high], blocks: runsOf(states), agents: {} }))
    assert.deepEqual(made.containers, [[...chest, {}], [...corner, {}]])
  })

  it('stream a frame of every tick in which something changed', async () => {
    await node.request('create_region', region('walk'))
    const { tick, results } = await node.request('run', { region: 'walk', programs: { sally: WALK }, timeout_ticks: 400 })
    assert.deepEqual(results.sally.error, null)
    assert.equal(tick, results.sally.ticks)
    const moves = node.frames.filter(frame => frame.agents.sally)
    const [x, y, z] = moves.at(-1).agents.sally.position
    assert.ok(Math.hypot(x - 5.5, z - 5.5) < 2, `${x} ${z}`)
    assert.equal(y, -51)
    const ticks = node.frames.map(frame => frame.tick)
    assert.deepEqual(ticks, [...new Set(ticks)].sort((a, b) => a - b))
  })

  it('do not hear or see one another', async () => {
    const agents = { sally: agent([0.5, -51, 0.5]), anne: agent([2.5, -51, 0.5]) }
    await node.request('create_region', region('one', { agents }))
    await node.request('create_region', region('two', { agents }))
    const look = `
      const heard = []
      bot.on('chat', (name, text) => heard.push(name + ':' + text))
      await bot.waitForTicks(5)
      const there = Object.keys(bot.players).sort().join()
      const bodies = Object.values(bot.entities).map(e => e.username + '@' + e.position).sort().join(' ')
      throw new Error([heard, there, bodies, bot.username].join('|'))`
    node.frames.length = 0
    const { results } = await node.request('run', {
      region: 'two', timeout_ticks: 20, programs: { sally: look, anne: 'bot.chat("hello")' }
    })
    assert.equal(results.sally.error.message,
      'anne:hello|anne,sally|anne@(2.5, -51, 0.5) sally@(0.5, -51, 0.5)|sally')
    const chats = node.frames.flatMap(frame => frame.events.map(event => [frame.region, event]))
    assert.deepEqual(chats, [['two', { kind: 'chat', actor: 'anne', detail: { text: 'hello' } }]])
    node.frames.length = 0
    await node.request('step', { region: 'one', ticks: 3 })
    assert.deepEqual(node.frames, [])
  })

  it('end at invisible walls', async () => {
    const box = [[0, -52, 0], [3, -49, 3]]
    await node.request('create_region', region('small', {
      box, blocks: floor([], box), agents: { sally: agent([1.5, -51, 1.5]) }
    }))
    const { results } = await node.request('run', {
      region: 'small',
      timeout_ticks: 60,
      programs: { sally: 'bot.setControlState("forward", true); bot.setControlState("jump", true); await bot.waitForTicks(40)' }
    })
    assert.equal(results.sally.error, null)
    const { agents } = await node.request('snapshot', { region: 'small' })
    assert.ok(agents.sally.position[2] >= 0.3, 'stopped at the north wall')
    assert.ok(node.frames.every(frame => frame.blocks.length === 0))
  })

  it('become as asked by changing what differs', async () => {
    await node.request('create_region', region('changed'))
    node.frames.length = 0
    const made = await node.request('apply', {
      region: 'changed',
      tick: 77,
      blocks: [[0, -51, 0, GLASS]],
      containers: [],
      items: {},
      agents: { anne: null, sally: agent([4.5, -51, 4.5], { yaw: 1, inventory: { dirt: 3 } }), zoe: agent([7.5, -51, 7.5]) }
    })
    assert.equal(made.tick, 77)
    assert.deepEqual(Object.keys(made.agents).sort(), ['observer', 'sally', 'zoe'])
    assert.deepEqual(made.agents.sally, agent([4.5, -51, 4.5], { yaw: 1, inventory: { dirt: 3 } }))
    assert.deepEqual(made.changes, [[0, -51, 0, GLASS]])
    await node.request('step', { region: 'changed', ticks: 10 })
    assert.deepEqual(node.frames, [])
    const again = await node.request('apply', {
      region: 'changed', tick: 87, blocks: [[0, -51, 0, AIR]], containers: [], items: {}, agents: {}
    })
    assert.deepEqual(again.changes, [[0, -51, 0, AIR]], 'only changes since the last snapshot')
  })

  it('report changed blocks', async () => {
    await node.request('create_region', region('dig'))
    node.frames.length = 0
    const { results } = await node.request('run', {
      region: 'dig', timeout_ticks: 400, programs: { sally: 'await bot.dig(bot.blockAt(new Vec3(0, -52, 2)))' }
    })
    assert.equal(results.sally.error, null)
    assert.deepEqual(node.frames.flatMap(frame => frame.blocks), [[0, -52, 2, AIR]])
    const updates = node.frames.flatMap(frame => frame.events).filter(event => event.kind === 'block_update')
    assert.deepEqual(updates, [{ kind: 'block_update', actor: null, detail: { position: [0, -52, 2], block: 'air' } }])
  })

  it('that are given up can be made again', async () => {
    await node.request('create_region', region('brief'))
    await node.request('destroy_region', { region: 'brief' })
    await assert.rejects(node.request('step', { region: 'brief', ticks: 1 }), { kind: 'bad_request' })
    const again = await node.request('create_region', region('brief'))
    assert.equal(Object.keys(again.agents).length, 3)
  })

  it('refuse what cannot be', async () => {
    const wrong = more => node.request('create_region', region('wrong', more))
    await assert.rejects(wrong({ blocks: floor().subarray(8) }), { kind: 'bad_request', message: /has 2116 blocks.* they have 2093$/ })
    await assert.rejects(wrong({ agents: { sally: agent([0.5, -51, 0.5], { inventory: { nothing_such: 1 } }) } }),
      { kind: 'bad_request', message: /nothing_such/ })
    const deep = [[0, -64, 0], [3, -60, 3]]
    await assert.rejects(wrong({ box: deep, blocks: floor([], deep) }), { kind: 'bad_request', message: /y = -63/ })
    await assert.rejects(wrong({ agents: { sally: agent([40.5, -51, 0.5]) } }), { kind: 'bad_request', message: /sally .* outside the box/ })
    await node.request('create_region', region('wrong', { box: BOX }))
    await assert.rejects(wrong({}), { kind: 'bad_request', message: /already/ })
    await assert.rejects(node.request('run', { region: 'wrong', programs: { nobody: '' }, timeout_ticks: 5 }),
      { kind: 'bad_request', message: /nobody/ })
  })
})
