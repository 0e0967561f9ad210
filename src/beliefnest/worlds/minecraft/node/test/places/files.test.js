'use strict'
const assert = require('node:assert/strict')
const { test } = require('node:test')
const zlib = require('node:zlib')
const nbt = require('prismarine-nbt')
const { readPlace } = require('../../src/places/files')
const { Box } = require('../../src/regions/box')
const { Terrain } = require('../../src/regions/terrain')

const CUT = { side: 8, margin: 1 }

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
function blocksOf ({ shape, palette: texts, blocks }) {
  const box = new Box([0, 0, 0], shape.map(length => length - 1))
  const terrain = Terrain.read(blocks, box)
  const textByPlace = {}
  box.forEach((x, y, z) => {
    const text = texts[terrain.at(x, y, z)]
    if (!text.endsWith('air')) textByPlace[[x, y, z]] = text
  })
  return textByPlace
}

for (const [kind, bytes] of [['version 2', schem2()], ['version 3', schem3()]]) {
  test(`a Sponge schematic of ${kind} is read`, () => {
    const place = readPlace(bytes, CUT)
    assert.deepEqual(place.shape, [2, 2, 3])
    const blocks = blocksOf(place)
    assert.equal(Object.values(blocks).filter(text => text === 'minecraft:stone').length, 6)
    assert.equal(blocks['0,1,0'], CHEST)
    assert.equal(blocks['1,1,0'], 'minecraft:oak_sign[rotation=4]')
    assert.deepEqual(place.containers, [[0, 1, 0, { bread: 3 }]])
    assert.deepEqual(place.signs, kind === 'version 3' ? [[1, 1, 0, 'left\nright']] : [])
  })
}

test('a structure file is read, and what it does not name is air', () => {
  const place = readPlace(structure(), CUT)
  assert.deepEqual(blocksOf(place), { '1,0,2': 'minecraft:stone', '0,1,0': 'minecraft:chest[facing=south]' })
  assert.deepEqual(place.containers, [[0, 1, 0, { bread: 3 }]])
})

test('what is no such file is refused with a sentence', () => {
  const cases = [
    [Buffer.from('a text'), /not a file of the game's data format/],
    [schem2().subarray(0, 40), /not a file of the game's data format/],
    [file(nbt.comp({ Materials: nbt.string('Alpha'), ...sides })), /before Minecraft 1\.13/],
    [file(nbt.comp({ Width: nbt.short(-1), Height: nbt.short(-1), Length: nbt.short(-1) })), /65535 x 65535 x 65535 blocks/],
    [file(nbt.comp({ ...sides })), /it has no blocks/],
    [schem2([-1, -1, -1, -1, -1, -1]), /not numbers/],
    [schem2([9]), /number 9, of which its palette/],
    [schem2([0, 0]), /has 2 blocks of 12/],
    [structure([0, 5, 0]), /outside its 2 x 2 x 3/],
    [file(nbt.comp({ size: nbt.list(nbt.int([4096, 4096, 65])) })), /its sides are 4096 x 4096 x 65 blocks; give a place of at most 1073741824/],
    // A list of 2 billion empty compounds, a list of as many ends, a text that is cut off.
    [Buffer.from([10, 0, 0, 9, 0, 1, 97, 10, 127, 255, 255, 255]), /it ends within the list at byte 12/],
    [Buffer.from([10, 0, 0, 9, 0, 1, 97, 0, 127, 255, 255, 255]), /it ends within the list at byte 12/],
    [Buffer.from([10, 0, 9, 97]), /it ends within the value at byte 3/],
    [Buffer.from([10, 0, 0, 99, 0, 0]), /unknown type 99/],
    [Buffer.concat([Buffer.from([10, 0, 0]), ...Array(1000).fill(Buffer.from([10, 0, 0]))]), /nested more than 512 deep/]
  ]
  for (const [bytes, said] of cases) assert.throws(() => readPlace(bytes, CUT), { message: said, kind: 'bad_request' })
})

test('values of other types than those of the format are refused with a sentence', () => {
  const plain = { ...sides, Palette: nbt.comp({ 'minecraft:air': nbt.int(0) }), BlockData: nbt.byteArray(Array(12).fill(0)) }
  const of = changes => file(nbt.comp({ ...plain, ...changes }))
  const chest = entity => of({ BlockEntities: nbt.list(nbt.comp([{ Pos: nbt.intArray([0, 0, 0]), ...entity }])) })
  const one = block => file(nbt.comp({ size: nbt.list(nbt.int([1, 1, 1])), palette: nbt.list(nbt.comp([{ Name: nbt.string('stone') }])), blocks: nbt.list(nbt.comp([block])) }))
  const stack = (id, count) => chest({ Items: nbt.list(nbt.comp([{ id, Count: count }])) })
  const cases = [
    [of({ Palette: nbt.string('stone') }), /its palette is no compound/],
    [of({ Palette: nbt.list(nbt.int([0])) }), /its palette is no compound/],
    [of({ Palette: nbt.comp({ 'minecraft:air': nbt.string('0') }) }), /a number that is none/],
    [of({ Palette: nbt.comp({ 'minecraft:air': nbt.float(0.5) }) }), /a number that is none/],
    [of({ Palette: nbt.comp({ a: nbt.int(0), b: nbt.int(0) }) }), /another block has/],
    [of({ BlockData: nbt.string('000000000000') }), /no array of bytes/],
    [of({ Width: nbt.string('2') }), /its sides are/],
    [of({ BlockEntities: nbt.string('x') }), /its block entities are no list/],
    [of({ BlockEntities: nbt.list(nbt.int([1])) }), /is no compound/],
    [of({ Regions: nbt.comp({}) }), /convert it to \.schem/],
    [stack(nbt.string('bread'), nbt.string('3')), /a count that is none/],
    [stack(nbt.string('bread'), nbt.double(1.5)), /a count that is none/],
    [stack(nbt.string('bread'), nbt.list(nbt.int([1]))), /a count that is none/],
    [stack(nbt.string(''), nbt.byte(1)), /without a name/],
    [file(nbt.comp({ size: nbt.list(nbt.int([1, 1, 1])), palette: nbt.string('stone') })), /are no list/],
    [file(nbt.comp({ size: nbt.list(nbt.int([1, 1, 1])), palette: nbt.list(nbt.int([1])) })), /is no compound/],
    [file(nbt.comp({ size: nbt.list(nbt.string(['a', 'b', 'c'])) })), /its sides are/],
    [one({ pos: nbt.list(nbt.int([0, 0, 0])), state: nbt.comp({}) }), /its blocks have number \[Object: null prototype\] \{\}/],
    [one({ pos: nbt.list(nbt.comp([{}, {}, {}])), state: nbt.int(0) }), /it has a block at \[/]
  ]
  for (const [bytes, said] of cases) assert.throws(() => readPlace(bytes, CUT), { message: said, kind: 'bad_request' })
})

test('changed bytes are refused with one line, or read', () => {
  let seed = 1
  const below = many => (seed = (seed * 1103515245 + 12345) & 0x7fffffff) % many
  const sound = [schem2(), structure()].map(bytes => zlib.gunzipSync(bytes))
  for (let turn = 0; turn < 4000; turn++) {
    let bytes = Buffer.from(sound[turn % 2])
    for (let changes = below(4); changes >= 0; changes--) {
      const at = below(bytes.length)
      bytes[at] = [below(256), below(13), 0x7f, 0xff][below(4)]
      if (below(4) === 0) bytes = Buffer.concat([bytes.subarray(0, at + 1), bytes.subarray(below(bytes.length))])
    }
    try {
      readPlace(bytes, CUT)
    } catch (error) {
      assert.equal(error.kind, 'bad_request', `${error.stack} of ${bytes.toString('hex')}`)
      assert.match(error.message, /^[^\n]{1,300}$/)
    }
  }
})

test('a palette may use any numbers, and names may be any', () => {
  const many = file(nbt.comp({ ...sides, Palette: nbt.comp({ 'minecraft:air': nbt.int(0), 'minecraft:stone': nbt.int(40000000) }), BlockData: nbt.byteArray(Array(12).fill(0)) }))
  assert.deepEqual(readPlace(many, CUT).palette, ['minecraft:air', 'minecraft:stone'])
  const entity = { Pos: nbt.intArray([0, 0, 0]), Items: nbt.list(nbt.comp([{ id: nbt.string('__proto__'), Count: nbt.byte(2) }])) }
  const odd = file(nbt.comp({ ...sides, Palette: nbt.comp({ 'minecraft:air': nbt.int(0) }), BlockData: nbt.byteArray(Array(12).fill(0)), BlockEntities: nbt.list(nbt.comp([entity])) }))
  assert.deepEqual(Object.entries(readPlace(odd, CUT).containers[0][3]), [['__proto__', 2]])
})

test('a sign whose text is nested without end has no text from there on', () => {
  const deep = `${'['.repeat(30000)}"x"${']'.repeat(30000)}`
  const sign = { Pos: nbt.intArray([0, 0, 0]), Text1: nbt.string(deep) }
  const place = readPlace(file(nbt.comp({ ...sides, Palette: nbt.comp({ 'minecraft:air': nbt.int(0) }), BlockData: nbt.byteArray(Array(12).fill(0)), BlockEntities: nbt.list(nbt.comp([sign])) })), CUT)
  assert.deepEqual(place.signs, [[0, 0, 0, '']])
})

test('a file that holds more values than a place has is refused before they are in memory', () => {
  const bytes = Buffer.concat([Buffer.from([10, 0, 0, 9, 0, 1, 97, 10, 2, 0, 0, 0]), Buffer.alloc(2 ** 25 + 1)])
  assert.throws(() => readPlace(zlib.gzipSync(bytes, { level: 1 }), CUT), { message: /holds more than 4194304 values/, kind: 'bad_request' })
})

test('a file that unpacks to more than the limit is refused with the limit', () => {
  const zeros = zlib.gzipSync(Buffer.alloc(256 * 2 ** 20 + 1), { level: 1 })
  assert.throws(() => readPlace(zeros, CUT), { message: 'it unpacks to more than 256 MiB, the limit for a place; give a file of a smaller place', kind: 'bad_request' })
})

test('a file that is packed twice is not unpacked twice', () => {
  assert.throws(() => readPlace(zlib.gzipSync(schem2()), CUT), { message: /not a file of the game's data format/, kind: 'bad_request' })
})

test('a place of several cubes is read, and takes the memory of its different cubes', () => {
  const [width, height, length] = [37, 20, 21]
  const numberAt = (x, y, z) => y < 12 ? 0 : (x * 7 + y * 5 + z * 3) % 11 === 0 ? 2 : 1
  const numbers = []
  for (let y = 0; y < height; y++) {
    for (let z = 0; z < length; z++) {
      for (let x = 0; x < width; x++) numbers.push(numberAt(x, y, z))
    }
  }
  const names = ['stone', 'air', 'glass']
  const place = readPlace(file(nbt.comp({
    Width: nbt.short(width), Height: nbt.short(height), Length: nbt.short(length), Palette: nbt.comp(Object.fromEntries(names.map((name, number) => [name, nbt.int(number)]))), BlockData: nbt.byteArray(numbers)
  })), CUT)
  const box = new Box([0, 0, 0], [width - 1, height - 1, length - 1])
  const terrain = Terrain.read(place.blocks, box)
  box.forEach((x, y, z) => assert.equal(place.palette[terrain.at(x, y, z)], names[numberAt(x, y, z)], `${x} ${y} ${z}`))
  const solid = terrain.rows.filter(row => row === terrain.rows[terrain.place(12, 3, 12)])
  assert.equal(solid.length, 5 * 3, 'one cube is used for the whole layer of stone')
})

test('a file of more than 16 million blocks is read', () => {
  const [width, height, length] = [500, 70, 500]
  const data = Buffer.alloc(width * height * length, 1)
  data.fill(0, 0, width * length * 8)
  const head = nbt.writeUncompressed({ name: '', ...nbt.comp({ Width: nbt.short(width), Height: nbt.short(height), Length: nbt.short(length), Palette: nbt.comp({ stone: nbt.int(0), air: nbt.int(1) }) }) })
  const named = Buffer.from([7, 0, 9, ...Buffer.from('BlockData'), 0, 0, 0, 0])
  named.writeInt32BE(data.length, named.length - 4)
  const place = readPlace(Buffer.concat([head.subarray(0, -1), named, data, Buffer.from([0])]), CUT)
  const terrain = Terrain.read(place.blocks, new Box([0, 0, 0], [width - 1, height - 1, length - 1]))
  assert.deepEqual([terrain.at(499, 7, 499), terrain.at(499, 8, 499)], [0, 1])
  assert.ok(terrain.chunks.length < 100)
})

test('a name in a file may be any text', () => {
  const bytes = file(nbt.comp({ __proto__: null, size: nbt.list(nbt.int([1, 1, 1])), ['__proto__']: nbt.comp({ blocks: nbt.int(3) }) }))
  assert.deepEqual(readPlace(bytes, CUT).shape, [1, 1, 1])
})
