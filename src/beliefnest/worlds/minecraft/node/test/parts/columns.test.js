'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
require('../../src/prepare').prepare()
const registry = require('prismarine-registry')('1.20.4')
const { rememberBlocks } = require('../../src/blocks')
const { Random } = require('../../src/time/random')
const Chunk = require('prismarine-chunk')(registry)

rememberBlocks(registry)

const STATES = [0, 1, 2, 79, 2955]
const HEIGHTS = [-64, -49, -48, 0, 15, 319]
const PLACES = HEIGHTS.flatMap(y => [0, 7, 15].flatMap(x => [0, 15].map(z => ({ x, y, z }))))

const column = () => new Chunk({ minY: -64, worldHeight: 384 })
const statesOf = chunk => PLACES.map(place => chunk.getBlockStateId(place))

describe('copies of a column', () => {
  it('share their sections until they change', () => {
    const source = column()
    source.setBlockStateId({ x: 1, y: -60, z: 1 }, 1)
    const [one, two] = [source.copy(), source.copy()]
    one.setBlockStateId({ x: 1, y: -60, z: 2 }, 1)
    assert.notEqual(one.sections[0], two.sections[0])
    for (let index = 1; index < 24; index++) assert.equal(one.sections[index], two.sections[index])
    assert.equal(source.getBlockStateId({ x: 1, y: -60, z: 2 }), 0)
    two.setBlockStateId({ x: 1, y: 320, z: 1 }, 1)
    assert.deepEqual(statesOf(two), statesOf(source), 'nothing is above the world')
  })

  it('never see one another change, whatever kind of section it is', () => {
    const random = new Random('columns')
    const below = number => Math.floor(random.next() * number)
    for (let round = 0; round < 30; round++) {
      const source = column()
      // From one state in a section over a short palette to so many that there is none.
      const put = (chunk, many) => chunk.setBlockStateId(PLACES[below(PLACES.length)], many ? 1 + below(20000) : STATES[below(STATES.length)])
      const isFull = round % 3 === 0
      for (let count = below(20); count > 0; count--) put(source, false)
      if (isFull) for (let i = 0; i < 300; i++) source.setBlockStateId({ x: i & 15, y: -50, z: (i >> 4) & 15 }, i + 1)
      const chunks = [source, source.copy(), source.copy()]
      const plain = chunks.map(statesOf)
      assert.deepEqual(plain[1], plain[0])
      for (let step = 0; step < 40; step++) {
        const which = below(chunks.length)
        put(chunks[which], isFull)
        plain[which] = statesOf(chunks[which])
        assert.deepEqual(chunks.map(statesOf), plain)
        assert.deepEqual(chunks.map(chunk => PLACES.map(place => chunk.getBlock(place).stateId)), plain)
      }
      assert.deepEqual(statesOf(chunks[1].copy()), plain[1])
      const sent = column()
      sent.load(chunks[2].dump())
      assert.deepEqual(statesOf(sent), plain[2], 'people are sent the same')
    }
  })
})
