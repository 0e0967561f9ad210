'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { TO_CLIENT, TO_SERVER } = require('../../src/net/packets')
const { Translator } = require('../../src/net/translate')
const protocol = require('minecraft-data')('1.20.4').protocol.play

const ORIGIN = { x: 16 * 1000, z: -16 * 7 }
const NAMES = new Map([['r1_sally', 'sally'], ['r1_anne', 'anne']])
const place = { x: 3.25, y: -51, z: -4.5 }
const block = { x: 3, y: -51, z: -4 }

/** A packet in scenario coordinates for every entry, and the same packet in the server's. */
const server = {
  point: { x: 16003.25, y: -51, z: -116.5 },
  block: { x: 16003, y: -51, z: -116 }
}
const chunk = (x, z) => [{ [x]: 0, [z]: -1 }, { [x]: 1000, [z]: -8 }]
const samples = {
  point: ({ field }) => wrap(field, place, server.point),
  block: ({ field }) => wrap(field, block, server.block),
  flat: () => [{ x: 3, z: -4 }, { x: 16003, z: -116 }],
  fixed: () => [{ x: 24, y: 8, z: -32 }, { x: 128024, y: 8, z: -928 }],
  absolute: () => [{ ...place, flags: 0 }, { ...server.point, flags: 0 }],
  chunk: ({ x, z, field }) => wrap(field, ...chunk(x, z)),
  chunks: ({ field }) => wrap(field, ...chunk('x', 'z').map(position => [{ position, data: 1 }])),
  death: ({ field }) => wrap(field, { dimensionName: 'd', location: block }, { dimensionName: 'd', location: server.block }),
  dig: () => [{ status: 0, location: block }, { status: 0, location: server.block }],
  players: ({ field }) => wrap(field,
    [{ uuid: 'u', player: { name: 'sally', properties: [] } }], [{ uuid: 'u', player: { name: 'r1_sally', properties: [] } }]),
  text: ({ field }) => wrap(field, { text: { value: '<sally> hi anne' } }, { text: { value: '<r1_sally> hi r1_anne' } }),
  words: ({ field }) => wrap(field, 'tell anne hi', 'tell r1_anne hi')
}

function wrap (field, scenario, world) {
  return field === undefined ? [scenario, world] : [{ [field]: scenario }, { [field]: world }]
}

const merged = entries => entries.map(entry => samples[entry.kind](entry))
  .reduce(([a, b], [c, d]) => [{ ...a, ...c }, { ...b, ...d }], [{ other: 1 }, { other: 1 }])

describe('translation', () => {
  const translator = new Translator(ORIGIN, NAMES)

  for (const [name, entries] of Object.entries(TO_CLIENT)) {
    it(`of ${name} to the client`, () => {
      const [scenario, world] = merged(entries)
      const kept = structuredClone(world)
      assert.deepEqual(translator.toClient(name, world), scenario)
      assert.deepEqual(world, kept, 'the original is left alone')
    })
  }

  for (const [name, entries] of Object.entries(TO_SERVER)) {
    it(`of ${name} to the server`, () => {
      const [scenario, world] = merged(entries)
      assert.deepEqual(translator.toServer(name, scenario), world)
    })
  }

  it('leaves distances alone', () => {
    assert.deepEqual(translator.toClient('position', { ...place, flags: 0b101 }), { ...place, flags: 0b101 })
    const drop = { status: 3, location: { x: 0, y: 0, z: 0 } }
    assert.deepEqual(translator.toServer('block_dig', drop), drop)
  })

  it('gives a copy of packets without places', () => {
    const packet = { message: 'hi' }
    const copy = translator.toServer('chat_message', packet)
    assert.deepEqual(copy, packet)
    assert.notEqual(copy, packet)
  })

  it('is exact, however far away the region is', () => {
    const there = new Translator({ x: 16 * 1600000, z: 16 })
    for (const x of [0.1, -7.123456789, 1 / 3]) {
      const back = there.toClient('position', there.toServer('position', { x, y: 0.1, z: x }))
      const near = new Translator({ x: 0, z: 0 })
      const same = near.toClient('position', near.toServer('position', { x, y: 0.1, z: x }))
      assert.deepEqual([back.x, back.z], [same.x, same.z])
      assert.ok(Math.abs(back.x - x) < 1e-7)
    }
  })

  it('does not take part of a name for a name', () => {
    const { content } = translator.toClient('system_chat', { content: { value: 'r1_sally2 r1_sally' } })
    assert.equal(content.value, 'r1_sally2 sally')
  })
})

/** Return the names of a packet's fields that hold an absolute position. */
function placesOf (type) {
  return type[1].filter(field => field.type === 'position' || field.name === 'x' || field.name === 'chunkX' ||
    JSON.stringify(field.type).includes('"position"') || /chunk(Coordinates|X)|sourcePosition/.test(field.name))
}

describe('the table', () => {
  // The x of a map's picture, of a sign's cursor and of a hit on an entity are no positions in the world.
  const RELATIVE = { toClient: ['map'], toServer: ['use_entity'] }

  for (const [direction, table] of [['toClient', TO_CLIENT], ['toServer', TO_SERVER]]) {
    it(`has every packet ${direction} that holds a place`, () => {
      const missing = Object.entries(protocol[direction].types)
        .filter(([name, type]) => name.startsWith('packet_') && type[0] === 'container' && placesOf(type).length > 0)
        .map(([name]) => name.slice('packet_'.length))
        .filter(name => !(name in table) && !RELATIVE[direction].includes(name))
      assert.deepEqual(missing, [])
    })
  }
})
