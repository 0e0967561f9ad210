'use strict'
/** Immediates of WebAssembly instructions: MVP, sign extension, saturating conversion, bulk memory. */

const none = () => undefined
const index = (reader) => reader.unsigned()
const constant = (reader) => reader.skipSigned()
const blockType = (reader) => reader.skipSigned()
const memoryAccess = (reader) => { reader.unsigned(); reader.unsigned() }

const SINGLE = new Map([
  [0x0e, (reader) => { reader.vector(index); reader.unsigned() }], // br_table
  [0x11, (reader) => { reader.unsigned(); reader.unsigned() }], // call_indirect
  [0x1c, (reader) => { reader.vector((r) => r.byte()) }], // select with types
  [0x41, constant], [0x42, constant],
  [0x43, (reader) => { reader.bytes(4) }], [0x44, (reader) => { reader.bytes(8) }],
  [0xfc, prefixed]
])

const RANGES = [
  [0x00, 0x01, none], [0x02, 0x04, blockType], [0x05, 0x05, none], [0x0b, 0x0b, none],
  [0x0c, 0x0d, index], [0x0f, 0x0f, none], [0x10, 0x10, index], [0x1a, 0x1b, none],
  [0x20, 0x26, index], [0x28, 0x3e, memoryAccess], [0x3f, 0x40, index], [0x45, 0xc4, none]
]

function prefixed (reader) {
  const code = reader.unsigned()
  if (code <= 7) return code
  if (code === 10) reader.bytes(2)
  else if (code === 11) reader.bytes(1)
  else throw new Error(`instruction 0xfc ${code} of the module is not known`)
  return code
}

const TABLE = Array.from({ length: 256 }, (_, op) =>
  SINGLE.get(op) ?? RANGES.find(([low, high]) => op >= low && op <= high)?.[2])

/**
 * Move the reader past the immediates of an instruction.
 * @param {import('./wasm-binary').Reader} reader reader, which has read the opcode
 * @param {number} op
 * @returns {number|undefined} the second opcode byte of a prefixed instruction
 * @throws {Error} for an instruction outside these proposals
 */
function skipImmediates (reader, op) {
  const skip = TABLE[op]
  if (skip === undefined) throw new Error(`instruction 0x${op.toString(16)} of the module is not known`)
  return op === 0xfc ? prefixed(reader) : void skip(reader)
}

module.exports = { skipImmediates }
