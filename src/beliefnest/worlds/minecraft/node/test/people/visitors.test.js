'use strict'
/** Visitors of a belief change nothing, whatever their clients send, and nobody in reality learns of them. */
const assert = require('node:assert/strict')
const { once } = require('node:events')
const path = require('node:path')
const { after, before, test } = require('node:test')
const minecraft = require('minecraft-protocol')
const versions = require('../../src/versions')
const { agent, BOX, floor, Node, region } = require('../harness')

const HOSTING = path.join(__dirname, '..', '..', 'src', 'hosting.js')
const CHEST = [-4, -51, 4]
const CHEST_STATE = require('minecraft-data')(versions.minecraft).blocksByName.chest.defaultState
const X = 1088
const SIGNED = { timestamp: 0n, salt: 0n, argumentSignatures: [], messageCount: 0, acknowledged: Buffer.alloc(3) }
const PLACED = { hand: 0, direction: 1, cursorX: 0.5, cursorY: 1, cursorZ: 0.5, insideBlock: false, sequence: 1 }

let node
let port
const clients = []

before(async () => {
  node = new Node(HOSTING)
  await node.request('hello', { protocol: 6, seed: 0, minecraft: versions.minecraft, listen: { host: '127.0.0.1', port: 0 } })
  ;({ port } = await node.request('people', { invited: ['anne'] }))
  await node.request('create_region', region('/', { agents: { anne: agent([-4.5, -51, 2.5]), sally: agent([0.5, -51, 0.5]) } }))
  await node.request('exhibit', {
    exhibit: '/sally', origin: [X, 0], stand: [X, -51, 0], box: BOX, blocks: floor([[...CHEST, CHEST_STATE]]), containers: [[...CHEST, { diamond: 3 }, false]], signs: [], agents: { sally_1: agent([0.5, -51, 0.5]) }
  })
})
after(async () => {
  for (const client of clients) client.socket?.destroy()
  await node.close()
})

const join = username => {
  const client = minecraft.createClient({ host: '127.0.0.1', port, username, version: versions.minecraft, auth: 'offline', hideErrors: true })
  client.on('error', () => {})
  clients.push(client)
  return client
}
const type = (client, command) => client.write('chat_command', { command, ...SIGNED })
const nextLine = async client => JSON.stringify((await once(client, 'system_chat'))[0].content)

test('a visitor is shown what stands there, and what their client sends changes nothing', async () => {
  const anne = join('anne')
  await once(anne, 'position')
  const listed = []
  anne.on('player_info', ({ data }) => listed.push(...data.map(({ player }) => player?.name)))
  const guest = join('guest')
  const names = []
  guest.on('player_info', ({ data }) => names.push(...data.map(({ player }) => player?.name)))
  assert.match(await nextLine(guest), /You look at \/sally: what sally believes/)
  assert.deepEqual(names, ['guest', 'sally_1'])
  const before = await node.request('snapshot', { region: '/' })

  const place = { x: X + CHEST[0], y: CHEST[1], z: CHEST[2] }
  const window = once(guest, 'window_items', { signal: AbortSignal.timeout(20_000) })
  guest.write('block_place', { ...PLACED, location: place })
  const [{ windowId, stateId, items }] = await window
  assert.equal(items[0].itemCount, 3)
  const again = once(guest, 'window_items')
  guest.write('window_click', { windowId, stateId, slot: 0, mouseButton: 0, mode: 0, changedSlots: [], cursorItem: { present: false } })
  assert.equal((await again)[0].items[0].itemCount, 3)
  const kept = once(guest, 'block_change')
  guest.write('block_dig', { status: 2, location: place, face: 1, sequence: 2 })
  assert.equal((await kept)[0].type, CHEST_STATE)
  guest.write('block_place', { ...PLACED, location: { x: 2_000_000, y: 4000, z: -3 } })
  guest.write('position', { x: 1e300, y: NaN, z: 0, onGround: true })
  guest.write('update_sign', { location: place, isFrontText: true, text1: 'a', text2: '', text3: '', text4: '' })
  guest.write('held_item_slot', { slotId: -5 })
  for (const [command, answer] of [['tp 1 2', /one command/], ['tp 500 0 0', /Nothing stands there/], ['tp anne 0 0 0', /yourself alone/], ['op guest', /one command/]]) {
    const line = nextLine(guest)
    type(guest, command)
    assert.match(await line, answer)
  }
  await node.request('step', { region: '/', ticks: 2 })
  assert.deepEqual({ ...await node.request('snapshot', { region: '/' }), tick: 0 }, { ...before, tick: 0 })
  assert.ok(!listed.includes('guest'))
})

test('who was taken over while they looked at something is called back when handed back', async () => {
  await node.request('exhibit', { exhibit: '/', origin: [0, 0], stand: [0, -51, 0], box: BOX, blocks: floor(), containers: [], signs: [], agents: {} })
  for (const client of clients.splice(0)) client.socket.destroy()
  while ((await node.request('people', { invited: ['anne'] })).here.length > 0) await node.request('step', { region: '/', ticks: 1 })
  const client = join('anne')
  const answerTo = async command => {
    const line = nextLine(client)
    type(client, command)
    return line
  }
  const handOver = async (invited, seen) => {
    const line = seen === undefined ? null : nextLine(client)
    assert.deepEqual((await node.request('people', { invited })).here, [])
    if (seen !== undefined) assert.match(await line, seen)
  }
  assert.match(await nextLine(client), /You are anne\. Here/)
  await answerTo(`tp ${X} -51 0`)
  await handOver([])
  await handOver(['anne'], /You can be anne again.*tp 0 -51 0/)
  assert.match(await answerTo('tp 0 -51 0'), /You are anne\. Here/)
  await answerTo(`tp ${X} -51 0`)
  await handOver([])
  assert.match(await answerTo('tp 0 -51 0'), /the real world.*anne is played by BeliefNest now/)
  await handOver(['anne'], /You are anne\. Here/)
  client.socket.destroy()
  await node.request('close_exhibit', { exhibit: '/' })
})

test('who is no longer to see anything has to go', async () => {
  const guest = join('other')
  await nextLine(guest)
  const [ended] = await Promise.all([once(guest, 'kick_disconnect'), node.request('close_exhibit', { exhibit: '/sally' })])
  assert.match(JSON.stringify(ended), /no longer shown/)
})
