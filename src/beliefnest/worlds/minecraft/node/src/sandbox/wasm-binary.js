'use strict'
/** Reader and writers of the WebAssembly binary format: LEB128 numbers, vectors, sections. */

class Reader {
  /**
   * @param {Uint8Array} data
   * @param {number} position offset at which reading starts
   */
  constructor (data, position = 0) {
    this.data = data
    this.position = position
  }

  get done () {
    return this.position >= this.data.length
  }

  byte () {
    if (this.done) throw new Error(`the module ends early, at byte ${this.position} of a section`)
    return this.data[this.position++]
  }

  bytes (length) {
    const slice = this.data.subarray(this.position, this.position + length)
    if (slice.length !== length) throw new Error(`the module ends early, at byte ${this.position} of a section`)
    this.position += length
    return slice
  }

  /** Read an unsigned LEB128 number of at most 32 bits. @returns {number} */
  unsigned () {
    let value = 0
    for (let shift = 0; shift < 35; shift += 7) {
      const byte = this.byte()
      value += (byte & 0x7f) * 2 ** shift
      if (byte < 0x80) return value
    }
    throw new Error(`the number before byte ${this.position} of a section is too long`)
  }

  /** Skip a signed LEB128 number of any width. */
  skipSigned () {
    while (this.byte() >= 0x80);
  }

  vector (read) {
    return Array.from({ length: this.unsigned() }, () => read(this))
  }

  limits () {
    const flags = this.byte()
    this.unsigned()
    if (flags & 1) this.unsigned()
  }

  * sections () {
    while (!this.done) {
      const start = this.position
      const id = this.byte()
      const content = this.bytes(this.unsigned())
      yield { id, content, whole: this.data.subarray(start, this.position) }
    }
  }
}

/** Return the LEB128 bytes of a non-negative number below 2^32. @returns {number[]} */
function unsigned (value) {
  const bytes = []
  do {
    const low = value % 128
    value = Math.floor(value / 128)
    bytes.push(value > 0 ? low | 0x80 : low)
  } while (value > 0)
  return bytes
}

/** Return a vector: the count, then the bytes of its entries in pieces. @returns {Buffer} */
function writeVector (pieces, count) {
  return Buffer.concat([Uint8Array.from(unsigned(count)), ...pieces])
}

/** Return a section: id, length, content. @returns {Buffer} */
function section (id, content) {
  return Buffer.concat([Uint8Array.from([id, ...unsigned(content.length)]), content])
}

module.exports = { Reader, writeVector, unsigned, section }
