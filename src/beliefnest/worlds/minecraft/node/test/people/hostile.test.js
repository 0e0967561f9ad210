'use strict'
/** Packets that no normal client would send. They end that client's connection at most, and harm nobody else. */
const assert = require('node:assert/strict')
const { once } = require('node:events')
const path = require('node:path')
const { after, afterEach, before, test } = require('node:test')
const minecraft = require('minecraft-protocol')
const versions = require('../../src/versions')
const { agent, floor, Node, region } = require('../harness')

const HOSTING = path.join(__dirname, '..', '..', 'src', 'hosting.js')
const CHEST = [-4, -51, 4]
const CHEST_STATE = require('minecraft-data')(versions.minecraft).blocksByName.chest.defaultState
const START = [-4.5, -51, 2.5]

let node
let port
const clients = []

before(async () => {
  node = new Node(HOSTING)
  await node.request('hello', { protocol: 6, seed: 0, minecraft: '1.20.4', listen: { host: '127.0.0.1', port: 0 } })
  ;({ port } = await node.request('people', { invited: ['anne'] }))
  await node.request('create_region', region('/', {
    blocks: floor([[...CHEST, CHEST_STATE]]), containers: [[...CHEST, { diamond: 3 }]], agents: { anne: agent(START), sally: agent([0.5, -51, 0.5]) }
  }))
})
after(() => node.close())
afterEach(async () => {
  for (const client of clients.splice(0)) client.socket?.destroy()
  await here([])
})

/** Let time pass until these people are there. */
async function here (names) {
  for (;;) {
    const { here: present } = await node.request('people', { invited: ['anne'] })
    if (present.join() === names.join()) return
    await node.request('step', { region: '/', ticks: 1 })
  }
}

const join = (username, version = versions.minecraft) => {
  const client = minecraft.createClient({ host: '127.0.0.1', port, username, version, auth: 'offline', hideErrors: true })
  client.on('error', () => {})
  clients.push(client)
  return client
}

async function anneIn () {
  const client = join('anne')
  await here(['anne'])
  return client
}

/** Let sent packets arrive, and let some time pass. */
async function settled (client) {
  const heard = once(client, 'system_chat')
  client.write('chat_command', { command: 'settled', timestamp: 0n, salt: 0n, argumentSignatures: [], messageCount: 0, acknowledged: Buffer.alloc(3) })
  await heard
  await node.request('step', { region: '/', ticks: 3 })
}

const snapshot = () => node.request('snapshot', { region: '/' })
const diamonds = ({ agents, containers }) => (agents.anne.inventory.diamond ?? 0) + (containers[0][3].diamond ?? 0)

test('who says to be outside the box, or nowhere, stays where they are', async () => {
  const client = await anneIn()
  for (const [x, y, z] of [[1e9, -51, 0], [0, 500, 0], [NaN, -51, 0], [0, -Infinity, 0], [0, -51, -13]]) {
    client.write('position', { x, y, z, onGround: true })
    client.write('position_look', { x, y, z, yaw: 0, pitch: 0, onGround: true })
  }
  await settled(client)
  assert.deepEqual((await snapshot()).agents.anne.position, START)
})

test('who says to be within a block, beyond one, or far away, stays where they were', async () => {
  const client = await anneIn()
  for (const [x, y, z] of [[START[0], -52, START[2]], [-3.5, -51, 6], [9.5, -51, 9.5]]) client.write('position', { x, y, z, onGround: true })
  await settled(client)
  assert.deepEqual((await snapshot()).agents.anne.position, START)
  for (const z of [3.5, START[2]]) {
    client.write('position', { x: START[0], y: START[1], z, onGround: true })
    await settled(client)
    assert.deepEqual((await snapshot()).agents.anne.position, [START[0], START[1], z])
  }
})

test('what is no line of text is refused with a sentence, and nobody hears it', async () => {
  const client = await anneIn()
  const lines = []
  client.on('system_chat', ({ content }) => lines.push(JSON.stringify(content)))
  client.chat('two\nlines')
  await settled(client)
  assert.match(lines.join('\n'), /what anne utters/)
  assert.equal(node.frames.flatMap(({ events }) => events).filter(({ kind }) => kind === 'chat').length, 0)
})

test('who is cut off with something in hand keeps it', async () => {
  const client = await anneIn()
  const chest = new Promise(resolve => client.on('window_items', packet => { if (packet.windowId !== 0) resolve(packet) }))
  client.write('block_place', {
    hand: 0, location: { x: CHEST[0], y: CHEST[1], z: CHEST[2] }, direction: 2, cursorX: 0.5, cursorY: 0.5, cursorZ: 0, insideBlock: false, sequence: 1
  })
  const { windowId, stateId } = await chest
  client.write('window_click', { windowId, stateId, slot: 0, mouseButton: 0, mode: 0, changedSlots: [], cursorItem: { present: false } })
  await settled(client)
  client.socket.destroy()
  await here([])
  const left = await snapshot()
  assert.equal(diamonds(left), 3)
  assert.deepEqual(left.agents.anne.inventory, { diamond: 3 })
  await anneIn()
  assert.deepEqual((await snapshot()).agents.anne.inventory, { diamond: 3 })
})

test('who says to look nowhere stays where they are and looks where they did', async () => {
  const client = await anneIn()
  for (const yaw of [NaN, Infinity]) {
    client.write('look', { yaw, pitch: 0, onGround: true })
    client.write('position_look', { x: START[0], y: START[1], z: START[2] + 1, yaw, pitch: 0, onGround: true })
  }
  await settled(client)
  const { anne } = (await snapshot()).agents
  assert.deepEqual([anne.position, anne.yaw, anne.pitch], [START, 0, 0])
})

test('a game of another version is told which one it has to be, and is not let in', async () => {
  const client = join('anne', '1.20.2')
  const entered = []
  client.on('success', () => entered.push('success'))
  const [[{ reason }]] = await Promise.all([once(client, 'disconnect'), once(client, 'end')])
  assert.match(reason, /This is Minecraft 1\.20\.4; start the game in that version/)
  assert.deepEqual(entered, [])
})

test('all that a game is sent of bots who sprint and sneak can be read', async () => {
  const client = await anneIn()
  const errors = []
  client.on('error', error => errors.push(error.message))
  const flags = []
  client.on('entity_metadata', ({ metadata }) => flags.push(...metadata.filter(({ key }) => key === 0)))
  await node.request('run', {
    region: '/', programs: { sally: 'for (const state of ["sprint", "sneak"]) for (const on of [true, false]) { bot.setControlState("forward", on); bot.setControlState(state, on); await bot.waitForTicks(3) }' }, timeout_ticks: 200
  })
  await settled(client)
  assert.deepEqual([errors, flags.map(({ type, value }) => [type, value])], [[], [['byte', 8], ['byte', 0], ['byte', 2], ['byte', 0]]])
})
