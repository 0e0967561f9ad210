'use strict'
const assert = require('node:assert/strict')
const { test } = require('node:test')
const { possessionsIn, signTextIn } = require('../../src/places/held')
const { parseSnbt } = require('../../src/remote/snbt')

test("the game's notation of data is read", () => {
  const text = '{Pos: [1.5d, -2.0E1d], id: "minecraft:bread", Count: 2b, name: \'it\\\'s "{x}"\', plain: air, UUID: [I; 1, -2], none: {}, empty: []}'
  assert.deepEqual(parseSnbt(text), {
    Pos: [1.5, -20], id: 'minecraft:bread', Count: 2, name: 'it\'s "{x}"', plain: 'air', UUID: [1, -2], none: {}, empty: []
  })
})

test('what is none of it is refused', () => {
  for (const text of ['', '{', '[1', '{a 1}', '{a: }', '[1 2]', '{a: 1} x', '"', '{:1}', ']']) assert.throws(() => parseSnbt(text), SyntaxError, text)
})

test('what somebody has is told alike by old and new versions', () => {
  const bread = { id: 'minecraft:bread', Slot: 3 }
  const helmet = { id: 'minecraft:iron_helmet' }
  const wanted = { inventory: { bread: 2, iron_helmet: 1 }, equipment: { main_hand: 'bread', head: 'iron_helmet' } }
  assert.deepEqual(possessionsIn({ Inventory: [{ ...bread, Count: 2 }, { ...helmet, Slot: 103, Count: 1 }] }, 3), wanted)
  assert.deepEqual(possessionsIn({ Inventory: [{ ...bread, count: 2 }], equipment: { head: { ...helmet, count: 1 } } }, 3), wanted)
})

test('signs are read as old and new versions write them', () => {
  const lines = texts => signTextIn({ front_text: { messages: texts } })
  assert.equal(lines(['{"text":"a","extra":["b"]}', '"c"', '""', '""']), 'ab\nc')
  assert.equal(lines(['a b', '12', { text: 'd' }, '']), 'a b\n12\nd')
  assert.equal(signTextIn({ Text1: '{"text":"a"}', Text2: '""', Text3: '""', Text4: '""' }), 'a')
})
