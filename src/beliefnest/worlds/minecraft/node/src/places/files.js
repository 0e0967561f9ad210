'use strict'
/**
 * Readers of files of places: Sponge schematics (`.schem`, versions 1 to 3, written by WorldEdit and others) and the
 * game's own structure files (`.nbt`). Blocks are returned as the texts of the file: names and properties.
 */
const { inspect } = require('node:util')
const zlib = require('node:zlib')
const { BadRequest } = require('../channel/errors')
const { Assembly } = require('../regions/assembly')
const { Box } = require('../regions/box')
const { signTextIn, stacksIn, totals } = require('./held')
const { readNbt } = require('./nbt')

// As in world/limits.py.
const MOST_BLOCKS = 2 ** 30
const LONGEST_SIDE = 4096
const MOST_CELLS = 2 ** 27
const MOST_BYTES = 256 * 2 ** 20
const GZIP = [0x1f, 0x8b]
const SHORT = 0xffff
const LONGEST_VARINT = 5
const LONGEST_QUOTE = 80
const MOST_ITEMS = 2 ** 31 - 1

/**
 * Read a place from the bytes of a file. It takes the memory of the unpacked file and of the place's different cubes.
 * @param {Uint8Array} bytes content of the file
 * @param {{side: number, margin: number}} cut how the place is cut into cubes (Assembly)
 * @returns {{shape: number[], palette: string[], blocks: object, containers: Array, signs: Array, special:
 *   Array}} `blocks` are BLOCKS of the channel in cubes, with numbers of the palette in place of states; `containers`
 *   [x, y, z, ITEMS] and `signs` [x, y, z, text] list all block entities with items or texts; `special` [x, y, z] lists
 *   those whose items have more than a name and count; positions count from the lowest corner
 * @throws {BadRequest} if the file is neither
 */
function readPlace (bytes, cut) {
  const data = dataOf(Buffer.from(bytes.buffer, bytes.byteOffset, bytes.byteLength))
  const root = data.Schematic ?? data
  requireCompound(root, 'the schematic')
  if (root.Materials !== undefined) throw new BadRequest('it is a schematic from before Minecraft 1.13, with numbers instead of block names; save it again as .schem')
  if (root.Regions !== undefined) throw new BadRequest('it is a schematic of Litematica (.litematic); convert it to .schem with Lite2Edit, or export it as a vanilla structure (.nbt) in the schematic manager of Litematica')
  const place = Array.isArray(root.size) ? structure(root, cut) : sponge(root, cut)
  const content = { containers: [], signs: [], special: [] }
  for (const { position, entity } of place.entities) readEntity(content, position, entity)
  return { shape: place.shape, palette: place.palette, blocks: place.blocks, ...content }
}

const isCompound = value => typeof value === 'object' && value !== null && !Array.isArray(value) && !ArrayBuffer.isView(value)

function requireCompound (value, what) {
  if (!isCompound(value)) throw new BadRequest(`${what} is no compound: it is damaged`)
  return value
}

/** Return a list of compounds; a list that is not there is empty. */
function compounds (value, what) {
  if (value !== undefined && !Array.isArray(value)) throw new BadRequest(`${what} are no list: it is damaged`)
  return (value ?? []).map(each => requireCompound(each, `one of ${what}`))
}

function dataOf (bytes) {
  try {
    return readNbt(unpacked(bytes))
  } catch (error) {
    if (error instanceof BadRequest) throw error
    throw new BadRequest(`it is not a file of the game's data format: ${error.message}`)
  }
}

function unpacked (bytes) {
  if (GZIP.some((byte, index) => bytes[index] !== byte)) return bytes
  try {
    return zlib.gunzipSync(bytes, { maxOutputLength: MOST_BYTES })
  } catch (error) {
    if (error.code !== 'ERR_BUFFER_TOO_LARGE') throw error
    throw new BadRequest(`it unpacks to more than ${MOST_BYTES / 2 ** 20} MiB, the limit for a place; give a file of a smaller place`)
  }
}

function requireShape (shape) {
  const isWhole = shape.length === 3 && shape.every(length => Number.isInteger(length) && length > 0 && length <= LONGEST_SIDE)
  const [size] = isWhole ? [shape[0] * shape[1] * shape[2]] : [NaN]
  if (!(size <= MOST_BLOCKS)) throw new BadRequest(`its sides are ${quoted(shape.join(' x '))} blocks; give a place of at most ${MOST_BLOCKS} blocks, up to ${LONGEST_SIDE} long`)
  return size
}

/** Return an empty assembly of a place. */
const assemblyOf = (shape, cut, blank) => new Assembly(new Box([0, 0, 0], shape.map(length => length - 1)), cut, blank)

/** Return a palette with air added, for cells that a file does not mention. */
const withAir = texts => ({ palette: [...texts, 'minecraft:air'], air: texts.length })

function structure ({ size, palette, palettes, blocks }, cut) {
  const shape = size.map(wholeOf)
  const { palette: texts, air } = withAir(compounds(palette ?? (Array.isArray(palettes) ? palettes[0] : palettes), 'its block states').map(stateText))
  requireShape(shape)
  const assembly = assemblyOf(shape, cut, air)
  const cubes = new Map()
  const entities = []
  const { side, margin } = cut
  for (const { pos: position, state, nbt: entity } of compounds(blocks, 'its blocks')) {
    requireInside(shape, position)
    requireKnown(texts, state)
    const cells = position.map(value => value + margin)
    const cube = cells.map(value => Math.floor(value / side))
    const key = cube.join()
    if (!cubes.has(key)) {
      assembly.requireRoom(cubes.size)
      cubes.set(key, { cube, states: new Int32Array(assembly.volume).fill(air) })
    }
    const [x, y, z] = cells.map(value => value % side)
    cubes.get(key).states[(x * side + y) * side + z] = state
    if (entity !== undefined) entities.push({ position, entity: requireCompound(entity, 'the data of a block') })
  }
  for (const { cube, states } of cubes.values()) assembly.put(cube, states)
  return { shape, palette: texts, blocks: assembly.terrain().message(), entities }
}

/** Return a number of a file as it is; a text or a list is none. */
const wholeOf = value => ['number', 'bigint'].includes(typeof value) ? Number(value) : NaN

function stateText ({ Name: name, Properties: properties = {} }) {
  if (typeof name !== 'string' || !isCompound(properties) || !Object.values(properties).every(value => typeof value === 'string')) throw new BadRequest('a block state of its palette has no name, or properties that are no texts: it is damaged')
  const inner = Object.entries(properties).map(entry => entry.join('=')).join(',')
  return inner === '' ? name : `${name}[${inner}]`
}

function sponge (root, cut) {
  const shape = [root.Width, root.Height, root.Length].map(side => wholeOf(side) & SHORT)
  const size = requireShape(shape)
  const { Palette: palette, Data: data, BlockEntities: entities } = root.Blocks ??
    { Palette: root.Palette, Data: root.BlockData, BlockEntities: root.BlockEntities ?? root.TileEntities }
  if (palette === undefined || data === undefined) throw new BadRequest('it has no blocks: neither a schematic nor a structure')
  if (!ArrayBuffer.isView(data)) throw new BadRequest('its blocks are no array of bytes: it is damaged')
  const { texts, indices } = numbered(requireCompound(palette, 'its palette'))
  // A block takes at least one byte: no memory is taken for the blocks of a file that has not so many.
  const layers = data.length < size ? undefined : new Layers(shape, cut)
  let count = 0
  eachVarint(data, number => {
    const index = indices.get(number)
    requireKnown(texts, index, number)
    if (count < size) layers?.add(index)
    count += 1
  })
  if (count !== size) throw new BadRequest(`it has ${count} blocks of ${size}: it is damaged`)
  return { shape, palette: texts, blocks: layers.terrain().message(), entities: compounds(entities, 'its block entities').map(entity => placed(shape, entity)) }
}

/**
 * Return the texts of a palette in a row, and for each number of the file the index of its text: a file may use any
 * numbers, also 40,000,000.
 */
function numbered (palette) {
  const texts = Object.keys(palette)
  const indices = new Map()
  texts.forEach((text, index) => {
    const number = palette[text]
    if (!Number.isInteger(number) || number < 0 || indices.has(number)) throw new BadRequest(`its palette gives ${quoted(text)} a number that is none, or that another block has: it is damaged`)
    indices.set(number, index)
  })
  return { texts, indices }
}

/** Return the beginning of any value of a file, for messages. */
function quoted (value) {
  const text = typeof value === 'string' ? value : inspect(value, { compact: true, depth: 1, breakLength: Infinity, maxArrayLength: LONGEST_QUOTE, maxStringLength: LONGEST_QUOTE })
  return text.length > LONGEST_QUOTE ? `${text.slice(0, LONGEST_QUOTE - 3)}...` : text
}

/** Assembly of a place whose blocks come in the order of schematics: x fastest, y slowest. It holds one layer of cubes. */
class Layers {
  constructor (shape, cut) {
    const { side, margin } = cut
    this.shape = shape
    this.cut = cut
    this.assembly = assemblyOf(shape, cut, 0)
    const { counts: [wide, , deep], volume } = this.assembly
    if (wide * deep * volume > MOST_CELLS) throw new BadRequest(`its sides are ${shape.join(' x ')} blocks, which is too wide; take a smaller place`)
    this.cells = new Int32Array(wide * deep * volume)
    // The index of a cell in the layer is a sum of one part for each axis.
    const parts = (length, whole, step) => Array.from({ length }, (_, at) => Math.floor((at + margin) / side) * whole + (at + margin) % side * step)
    this.parts = [parts(shape[0], deep * volume, side * side), parts(shape[1], 0, side), parts(shape[2], volume, 1)]
    this.at = [0, 0, 0]
  }

  /** Set the next block. */
  add (number) {
    const { at, shape, parts, cells } = this
    cells[parts[0][at[0]] + parts[1][at[1]] + parts[2][at[2]]] = number
    if (++at[0] < shape[0]) return
    at[0] = 0
    if (++at[2] < shape[2]) return
    at[2] = 0
    at[1] += 1
    if (at[1] === shape[1] || (at[1] + this.cut.margin) % this.cut.side === 0) this.end()
  }

  /** End a layer of cubes. */
  end () {
    const { assembly, cells, cut: { side, margin } } = this
    const { counts: [wide, , deep], volume } = assembly
    const layer = Math.floor((this.at[1] - 1 + margin) / side)
    for (let i = 0, start = 0; i < wide; i++) {
      for (let k = 0; k < deep; k++, start += volume) assembly.put([i, layer, k], cells.subarray(start, start + volume))
    }
    cells.fill(0)
  }

  terrain () {
    return this.assembly.terrain()
  }
}

function placed (shape, { Pos: position, Data: data, ...more }) {
  requireInside(shape, position)
  return { position: [...position], entity: data === undefined ? more : requireCompound(data, 'the data of a block') }
}

/** Call `visit(number)` for each number of variable length in some bytes. */
function eachVarint (bytes, visit) {
  let value = 0
  let length = 0
  for (const byte of bytes) {
    value |= (byte & 127) << (7 * length)
    if (++length > LONGEST_VARINT) throw new BadRequest('its blocks are not numbers of the schematic format')
    if ((byte & 128) !== 0) continue
    visit(value)
    value = length = 0
  }
}

function requireKnown (texts, index, number = index) {
  if (!Number.isInteger(index) || texts[index] === undefined) throw new BadRequest(`its blocks have number ${quoted(number)}, of which its palette says nothing`)
}

function requireInside (shape, position) {
  // Positions are lists, or arrays of bytes or numbers.
  const isInside = (Array.isArray(position) || ArrayBuffer.isView(position)) && position.length === 3 && position.every((value, axis) => Number.isInteger(value) && value >= 0 && value < shape[axis])
  if (!isInside) throw new BadRequest(`it has a block at ${quoted(position)}, which is outside its ${shape.join(' x ')} blocks`)
}

function readEntity ({ containers, signs, special }, position, entity) {
  if (Array.isArray(entity.Items)) {
    const stacks = stacksIn(compounds(entity.Items, 'the items of a container'))
    const bad = stacks.find(({ name, count }) => name === '' || !Number.isInteger(count) || count < 1 || count > MOST_ITEMS)
    if (bad !== undefined) throw new BadRequest(`the container at ${position.join(', ')} has a stack without a name, or with a count that is none: it is damaged`)
    containers.push([...position, totals(stacks)])
    if (stacks.some(stack => !stack.isPlain)) special.push([...position])
  }
  if (entity.front_text !== undefined || entity.Text1 !== undefined) signs.push([...position, signTextIn(entity)])
}

module.exports = { readPlace }
