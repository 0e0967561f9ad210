'use strict'
const assert = require('node:assert/strict')
const { test } = require('node:test')
const zlib = require('node:zlib')
const nbt = require('prismarine-nbt')
const { readPlace } = require('../../src/places/files')

const CHEST = 'minecraft:chest[facing=south]'
const PALETTE = { 'minecraft:stone': 0, [CHEST]: 1, 'minecraft:oak_sign[rotation=4]': 200, 'minecraft:air': 3 }
const stack = (name, count) => nbt.comp({ Slot: nbt.byte(0), id: nbt.string(name), Count: nbt.byte(count) })
const compounds = list => nbt.list(nbt.comp(list.map(({ value }) => value)))
const HELD = { Items: compounds([stack('minecraft:bread', 2), stack('minecraft:bread', 1)]) }
const WRITTEN = { front_text: nbt.comp({ messages: nbt.list(nbt.string(['{"text":"left"}', '"right"', '""', '""'])) }) }

/** Blocks of a place of 2 x 2 x 3: a floor of stone, and on it a chest, a sign and air. */
const NUMBERS = [0, 0, 0, 0, 0, 0, 1, 200, 3, 3, 3, 3]
const BYTES = NUMBERS.flatMap(number => number < 128 ? [number] : [(number & 127) | 128, number >> 7]).map(byte => byte << 24 >> 24)

const palette = nbt.comp(Object.fromEntries(Object.entries(PALETTE).map(([text, number]) => [text, nbt.int(number)])))
const sides = { Width: nbt.short(2), Height: nbt.short(2), Length: nbt.short(3) }
const file = root => zlib.gzipSync(nbt.writeUncompressed({ name: '', ...root }))

function schem2 (numbers = BYTES) {
  return file(nbt.comp({
    Version: nbt.int(2), DataVersion: nbt.int(3700), ...sides, Palette: palette, BlockData: nbt.byteArray(numbers), BlockEntities: compounds([nbt.comp({ Id: nbt.string('minecraft:chest'), Pos: nbt.intArray([0, 1, 0]), ...HELD })])
  }))
}

function schem3 () {
  const entity = (position, data) => nbt.comp({ Id: nbt.string('minecraft:any'), Pos: nbt.intArray(position), Data: nbt.comp(data) })
  return file(nbt.comp({
    Schematic: nbt.comp({ Version: nbt.int(3), ...sides, Blocks: nbt.comp({ Palette: palette, Data: nbt.byteArray(BYTES), BlockEntities: compounds([entity([0, 1, 0], HELD), entity([1, 1, 0], WRITTEN)]) }) })
  }))
}

function structure (position = [0, 1, 0]) {
  const block = (state, place, entity) => nbt.comp({ state: nbt.int(state), pos: nbt.list(nbt.int(place)), ...entity && { nbt: nbt.comp(entity) } })
  return file(nbt.comp({
    size: nbt.list(nbt.int([2, 2, 3])),
    palette: compounds([nbt.comp({ Name: nbt.string('minecraft:stone') }), nbt.comp({ Name: nbt.string('minecraft:chest'), Properties: nbt.comp({ facing: nbt.string('south') }) })]),
    blocks: compounds([block(0, [1, 0, 2]), block(1, position, HELD)])
  }))
}

/** Return the blocks of a file: text by position, without air. */
function blocksOf ({ shape: [width, height, length], palette: texts, blocks }) {
  const numbers = new Int32Array(blocks.buffer)
  const found = {}
  for (let x = 0, index = 0; x < width; x++) {
    for (let y = 0; y < height; y++) {
      for (let z = 0; z < length; z++, index++) {
        if (!texts[numbers[index]].endsWith('air')) found[[x, y, z]] = texts[numbers[index]]
      }
    }
  }
  return found
}

for (const [kind, bytes] of [['version 2', schem2()], ['version 3', schem3()]]) {
  test(`a Sponge schematic of ${kind} is read`, async () => {
    const place = await readPlace(bytes)
    assert.deepEqual(place.shape, [2, 2, 3])
    const found = blocksOf(place)
    assert.equal(Object.values(found).filter(text => text === 'minecraft:stone').length, 6)
    assert.equal(found['0,1,0'], CHEST)
    assert.equal(found['1,1,0'], 'minecraft:oak_sign[rotation=4]')
    assert.deepEqual(place.containers, [[0, 1, 0, { bread: 3 }]])
    assert.deepEqual(place.signs, kind === 'version 3' ? [[1, 1, 0, 'left\nright']] : [])
  })
}

test('a structure file is read, and what it does not name is air', async () => {
  const place = await readPlace(structure())
  assert.deepEqual(blocksOf(place), { '1,0,2': 'minecraft:stone', '0,1,0': 'minecraft:chest[facing=south]' })
  assert.deepEqual(place.containers, [[0, 1, 0, { bread: 3 }]])
})

test('what is no such file is refused with a sentence', async () => {
  const cases = [
    [Buffer.from('a text'), /not a file of the game's data format/],
    [schem2().subarray(0, 40), /not a file of the game's data format/],
    [file(nbt.comp({ Materials: nbt.string('Alpha'), ...sides })), /before Minecraft 1\.13/],
    [file(nbt.comp({ Width: nbt.short(-1), Height: nbt.short(-1), Length: nbt.short(-1) })), /65535 x 65535 x 65535 blocks/],
    [file(nbt.comp({ ...sides })), /it has no blocks/],
    [schem2([-1, -1, -1, -1, -1, -1]), /not numbers/],
    [schem2([9]), /number 9, of which its palette/],
    [schem2([0, 0]), /has 2 blocks of 12/],
    [structure([0, 5, 0]), /outside its 2 x 2 x 3/]
  ]
  for (const [bytes, said] of cases) await assert.rejects(readPlace(bytes), { message: said, kind: 'bad_request' })
})

test('a file that unpacks to more than the limit is refused with the limit', async () => {
  const zeros = zlib.gzipSync(Buffer.alloc(256 * 2 ** 20 + 1), { level: 1 })
  await assert.rejects(readPlace(zeros), { message: 'it unpacks to more than 256 MiB, the limit for a place; give a file of a smaller place', kind: 'bad_request' })
})

test('a file that is packed twice is not unpacked twice', async () => {
  await assert.rejects(readPlace(zlib.gzipSync(schem2())), { message: /not a file of the game's data format/, kind: 'bad_request' })
})
