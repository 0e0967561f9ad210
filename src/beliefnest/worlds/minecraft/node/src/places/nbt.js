'use strict'
/**
 * Reader of the game's data format NBT, big endian: https://minecraft.wiki/w/NBT_format. It returns plain values, and
 * arrays of bytes as views of the file, so that a large place is in memory once.
 */

// The game's own limit.
const DEEPEST = 512
// A value takes up to a few hundred bytes of memory, and as little as one in the file.
const MOST_VALUES = 2 ** 22
const END = 0
const COMPOUND = 10

class Reader {
  constructor (bytes) {
    this.bytes = bytes
    this.at = 0
    this.depth = 0
    this.count = 0
  }

  /** Return the position of the next `size` bytes, and go on behind them. */
  take (size) {
    if (size < 0 || size > this.bytes.length - this.at) throw new RangeError(`it ends within the value at byte ${this.at}`)
    const from = this.at
    this.at += size
    return from
  }

  /** Return the value of a type. */
  value (type) {
    const { bytes } = this
    if (++this.count > MOST_VALUES) throw new RangeError(`it holds more than ${MOST_VALUES} values`)
    switch (type) {
      case 1: return bytes.readInt8(this.take(1))
      case 2: return bytes.readInt16BE(this.take(2))
      case 3: return bytes.readInt32BE(this.take(4))
      case 4: return bytes.readBigInt64BE(this.take(8))
      case 5: return bytes.readFloatBE(this.take(4))
      case 6: return bytes.readDoubleBE(this.take(8))
      case 7: return this.slice(this.value(3))
      case 8: return this.text()
      case 9: return this.nested(() => this.elements(bytes.readUInt8(this.take(1))))
      case COMPOUND: return this.nested(() => this.compound())
      case 11: return this.elements(3, 4)
      case 12: return this.elements(4, 8)
      default: throw new RangeError(`it has a value of the unknown type ${type} at byte ${this.at}`)
    }
  }

  slice (size) {
    const from = this.take(size)
    return this.bytes.subarray(from, from + size)
  }

  text () {
    return this.slice(this.bytes.readUInt16BE(this.take(2))).toString('utf8')
  }

  nested (read) {
    if (++this.depth > DEEPEST) throw new RangeError(`it is nested more than ${DEEPEST} deep`)
    const value = read()
    this.depth -= 1
    return value
  }

  /** Return the elements of a list; `least` is the least number of bytes of one. */
  elements (type, least = 1) {
    const count = Math.max(this.value(3), 0)
    // Refuse a list that is longer than the file before there is an array of its length.
    if (type === END ? count > 0 : count * least > this.bytes.length - this.at) throw new RangeError(`it ends within the list at byte ${this.at}`)
    if (count > MOST_VALUES) throw new RangeError(`it holds more than ${MOST_VALUES} values`)
    return Array.from({ length: count }, () => this.value(type))
  }

  compound () {
    // Names come from the file: `__proto__` is one as any other.
    const entries = Object.create(null)
    for (let type = this.bytes.readUInt8(this.take(1)); type !== END; type = this.bytes.readUInt8(this.take(1))) {
      const name = this.text()
      entries[name] = this.value(type)
    }
    return entries
  }
}

/**
 * Return the content of a file.
 * @param {Buffer} bytes bytes of a compound, not packed
 * @returns {object} numbers, texts, arrays, and objects without a prototype; 64-bit numbers are BigInt
 * @throws {RangeError} if the bytes are no compound
 */
function readNbt (bytes) {
  const reader = new Reader(bytes)
  const type = bytes.readUInt8(reader.take(1))
  if (type !== COMPOUND) throw new RangeError(`it begins with a value of type ${type}`)
  reader.text()
  return reader.value(COMPOUND)
}

module.exports = { readNbt }
