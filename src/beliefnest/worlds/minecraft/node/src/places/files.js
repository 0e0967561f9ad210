'use strict'
/**
 * Readers of files of places: Sponge schematics (`.schem`, versions 1 to 3, written by WorldEdit and others) and the
 * game's own structure files (`.nbt`). Blocks are returned as the texts of the file: names and properties.
 */
const zlib = require('node:zlib')
const nbt = require('prismarine-nbt')
const { BadRequest } = require('../channel/errors')
const { signTextIn, stacksIn, totals } = require('./held')

const MOST_BLOCKS = 8_000_000
const MOST_BYTES = 256 * 2 ** 20
const GZIP = [0x1f, 0x8b]
const SHORT = 0xffff
const LONGEST_VARINT = 5

/**
 * Read a place from the bytes of a file.
 * @param {Uint8Array} bytes content of the file
 * @returns {Promise<{shape: number[], palette: string[], blocks: Uint8Array, containers: Array, signs: Array, special:
 *   Array}>} `blocks` are indices of the palette as Int32, x slowest, z fastest; `containers` [x, y, z, ITEMS] and
 *   `signs` [x, y, z, text] list all block entities with items or texts; `special` [x, y, z] lists those whose items
 *   have more than a name and count; positions count from the lowest corner
 * @throws {BadRequest} if the file is neither
 */
async function readPlace (bytes) {
  const data = dataOf(Buffer.from(bytes))
  const root = data.Schematic ?? data
  if (root.Materials !== undefined) throw new BadRequest('it is a schematic from before Minecraft 1.13, with numbers instead of block names; save it again as .schem')
  const place = Array.isArray(root.size) ? structure(root) : sponge(root)
  const found = { containers: [], signs: [], special: [] }
  for (const { position, entity } of place.entities) readEntity(found, position, entity)
  return { shape: place.shape, palette: place.palette, blocks: new Uint8Array(place.blocks.buffer), ...found }
}

/**
 * Parse a file that may be packed with gzip, once: `nbt.parse` would unpack further layers without a bound.
 */
function dataOf (bytes) {
  try {
    return nbt.simplify(nbt.parseUncompressed(unpacked(bytes), 'big'))
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
  const isWhole = shape.length === 3 && shape.every(length => Number.isInteger(length) && length > 0)
  const [size] = isWhole ? [shape[0] * shape[1] * shape[2]] : [NaN]
  if (!(size <= MOST_BLOCKS)) throw new BadRequest(`its sides are ${shape.join(' x ')} blocks; give a place of at most ${MOST_BLOCKS} blocks`)
  return size
}

/** Return a palette with air added, for cells that a file does not mention. */
const withAir = texts => ({ palette: [...texts, 'minecraft:air'], air: texts.length })

function structure ({ size, palette, palettes, blocks }) {
  const shape = size.map(Number)
  const { palette: texts, air } = withAir((palette ?? palettes?.[0] ?? []).map(stateText))
  const cells = new Int32Array(requireShape(shape)).fill(air)
  const entities = []
  for (const { pos: position, state, nbt: entity } of blocks ?? []) {
    requireInside(shape, position)
    requireKnown(texts, state)
    cells[cellOf(shape, position)] = state
    if (entity !== undefined) entities.push({ position, entity })
  }
  return { shape, palette: texts, blocks: cells, entities }
}

function stateText ({ Name: name, Properties: properties = {} }) {
  const inner = Object.entries(properties).map(entry => entry.join('=')).join(',')
  return inner === '' ? String(name) : `${name}[${inner}]`
}

function sponge (root) {
  const shape = [root.Width, root.Height, root.Length].map(side => side & SHORT)
  const size = requireShape(shape)
  const { Palette: palette, Data: data, BlockEntities: entities = [] } = root.Blocks ??
    { Palette: root.Palette, Data: root.BlockData, BlockEntities: root.BlockEntities ?? root.TileEntities }
  if (palette === undefined || data === undefined) throw new BadRequest('it has no blocks: neither a schematic nor a structure')
  const texts = []
  for (const [text, number] of Object.entries(palette)) texts[number] = text
  const cells = new Int32Array(size)
  const [width, , length] = shape
  let count = 0
  for (const number of varints(data)) {
    requireKnown(texts, number)
    const [x, z] = [count % width, Math.floor(count / width) % length]
    if (count < size) cells[cellOf(shape, [x, Math.floor(count / (width * length)), z])] = number
    count += 1
  }
  if (count !== size) throw new BadRequest(`it has ${count} blocks of ${size}: it is damaged`)
  return { shape, palette: Array.from(texts, text => text ?? 'minecraft:air'), blocks: cells, entities: entities.map(entity => placed(shape, entity)) }
}

function placed (shape, { Pos: position, Data: data, ...more }) {
  requireInside(shape, position)
  return { position: [...position], entity: data ?? more }
}

function * varints (bytes) {
  let value = 0
  let length = 0
  for (const byte of bytes) {
    value |= (byte & 127) << (7 * length)
    if (++length > LONGEST_VARINT) throw new BadRequest('its blocks are not numbers of the schematic format')
    if ((byte & 128) !== 0) continue
    yield value
    value = length = 0
  }
}

function requireKnown (texts, number) {
  if (texts[number] === undefined) throw new BadRequest(`its blocks have number ${number}, of which its palette says nothing`)
}

function requireInside (shape, position) {
  const isInside = position?.length === 3 && [...position].every((value, axis) => value >= 0 && value < shape[axis])
  if (!isInside) throw new BadRequest(`it has a block at ${[...position ?? []].join(', ')}, which is outside its ${shape.join(' x ')} blocks`)
}

const cellOf = ([, height, length], [x, y, z]) => (x * height + y) * length + z

function readEntity ({ containers, signs, special }, position, entity) {
  if (Array.isArray(entity.Items)) {
    const stacks = stacksIn(entity.Items)
    containers.push([...position, totals(stacks)])
    if (stacks.some(stack => !stack.isPlain)) special.push([...position])
  }
  if (entity.front_text !== undefined || entity.Text1 !== undefined) signs.push([...position, signTextIn(entity)])
}

module.exports = { readPlace }
