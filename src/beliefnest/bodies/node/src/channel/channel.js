'use strict'
/** Length-prefixed msgpack messages over a stream: 4 bytes big endian, then one map. */
const { encode, decode } = require('@msgpack/msgpack')

const HEADER = 4

class Channel {
  /**
   * @param {import('node:stream').Duplex} stream
   * @param {(message: object) => void} receive hears every message
   */
  constructor (stream, receive) {
    this.stream = stream
    this.receive = receive
    this.pending = Buffer.alloc(0)
    stream.on('data', chunk => this.take(chunk))
  }

  send (message) {
    const body = encode(message, { ignoreUndefined: true })
    const packet = Buffer.allocUnsafe(HEADER + body.length)
    packet.writeUInt32BE(body.length, 0)
    packet.set(body, HEADER)
    this.stream.write(packet)
  }

  take (chunk) {
    this.pending = this.pending.length === 0 ? chunk : Buffer.concat([this.pending, chunk])
    for (;;) {
      if (this.pending.length < HEADER) return
      const end = HEADER + this.pending.readUInt32BE(0)
      if (this.pending.length < end) return
      const body = this.pending.subarray(HEADER, end)
      this.pending = this.pending.subarray(end)
      this.receive(decode(body))
    }
  }
}

module.exports = { Channel }
