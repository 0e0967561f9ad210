'use strict'
const assert = require('node:assert/strict')
const { EventEmitter } = require('node:events')
const { describe, it } = require('node:test')
const { Channel } = require('../../src/channel/channel')
const { Allotment } = require('../../src/regions/allotment')
const { Box, runsOf, statesOf } = require('../../src/regions/box')
const { angleStep, fromDegrees, samePose, toDegrees, wrap } = require('../../src/server/angles')
const { makeRegional, regionalState } = require('../../src/server/regional')

describe('a box', () => {
  const box = new Box([-1, 5, 2], [1, 6, 4])

  it('counts its blocks, x slowest and z fastest', () => {
    assert.equal(box.size, 18)
    const visited = []
    box.forEach((x, y, z, index) => {
      assert.equal(box.index(x, y, z), index)
      visited.push([x, y, z])
    })
    assert.equal(visited.length, 18)
    assert.deepEqual(visited.slice(0, 4), [[-1, 5, 2], [-1, 5, 3], [-1, 5, 4], [-1, 6, 2]])
  })

  it('knows what is in it', () => {
    assert.ok(box.contains(1, 6, 4))
    assert.ok(!box.contains(2, 6, 4) && !box.contains(1, 7, 4) && !box.contains(1, 6, 5) && !box.contains(1, 4, 4))
    assert.deepEqual(box.grown().low, [-2, 4, 1])
  })
})

describe('runs of blocks', () => {
  const box = new Box([0, 0, 0], [0, 1, 3])

  it('give back the states that they were made of', () => {
    for (const states of [[0, 0, 0, 0, 0, 0, 0, 0], [1, 1, 0, 2, 2, 2, -1, -1], [1, 2, 3, 4, 5, 6, 7, 8]]) {
      assert.deepEqual(statesOf(runsOf(Int32Array.from(states)), box), Int32Array.from(states))
    }
    assert.deepEqual([...new Int32Array(runsOf(Int32Array.from([5, 5, 5, 0, 0, 0, 0, 9])).buffer)], [5, 3, 0, 4, 9, 1])
  })

  it('are refused if they have not as many blocks as the box', () => {
    const bytes = (...rows) => new Uint8Array(Int32Array.from(rows).buffer)
    for (const wrong of [bytes(), bytes(1, 7), bytes(1, 9), bytes(1, 8, 0), bytes(1, 8, 2, -1, 3, 1)]) {
      assert.throws(() => statesOf(wrong, box), /has 8 blocks/)
    }
  })
})

describe('the channel', () => {
  it('reads messages however they are cut', () => {
    const [sent, stream] = [[], Object.assign(new EventEmitter(), { write: bytes => sent.push(bytes) })]
    const received = []
    const channel = new Channel(stream, message => received.push(message))
    const messages = [{ a: 1 }, { text: 'x'.repeat(70000) }, {}, { list: [1, 2, 3] }]
    for (const message of messages) channel.send(message)
    const bytes = Buffer.concat(sent)
    for (const size of [1, 3, 7, 4096, bytes.length]) {
      received.length = 0
      for (let from = 0; from < bytes.length; from += size) stream.emit('data', bytes.subarray(from, from + size))
      assert.deepEqual(received, messages, `in pieces of ${size} bytes`)
    }
  })
})

describe('the allotment', () => {
  it('gives whole chunks far apart, and strips that were given back again', () => {
    const allotment = new Allotment()
    const box = new Box([-11, -52, -11], [11, -49, 11])
    const places = [1, 2, 3].map(() => allotment.take(box))
    assert.ok(places.every(({ x, z }) => x % 16 === 0 && z % 16 === 0))
    assert.ok(places[1].x - places[0].x > 1000)
    allotment.giveBack(places[1])
    assert.equal(allotment.take(box).x, places[1].x)
    const huge = allotment.take(new Box([0, 0, 0], [5000, 1, 1]))
    assert.ok(huge.x > places[2].x)
  })
})

describe('angles', () => {
  it('go to degrees and back', () => {
    for (const yaw of [-3, -1.5, 0, 0.3, Math.PI]) {
      const pose = { yaw, pitch: yaw / 3 }
      const { yaw: a, pitch: b } = toDegrees(pose)
      assert.ok(samePose(fromDegrees(a, b), pose), `${yaw}`)
    }
    assert.deepEqual(toDegrees({ yaw: Math.PI, pitch: 0 }), { yaw: 0, pitch: -0 })
  })

  it('are the same after a whole turn', () => {
    assert.ok(Math.abs(wrap(7) - (7 - 2 * Math.PI)) < 1e-12)
    assert.equal(wrap(-Math.PI), Math.PI)
    assert.ok(!samePose({ yaw: 0, pitch: 0 }, { yaw: 0.001, pitch: 0 }))
  })

  it('become signed bytes', () => {
    assert.deepEqual([0, 90, 180, 270, -90].map(angleStep), [0, 64, -128, -64, -64])
  })
})

describe('regional state', () => {
  it('is that of the active region', () => {
    const serv = {}
    makeRegional(serv)
    serv.players.push('nobody')
    const [one, two] = [{ state: regionalState() }, { state: regionalState() }]
    serv.region = one
    assert.deepEqual(serv.players, [])
    serv.players.push('sally')
    serv.entityMaxId += 5
    serv.region = two
    assert.deepEqual([serv.players, serv.entityMaxId], [[], 0])
    serv.region = one
    assert.deepEqual([serv.players, serv.entityMaxId], [['sally'], 5])
  })
})
