'use strict'
/** Channel of length-prefixed msgpack messages over a stream: 4 bytes big endian, then one map. */
const { decode, Encoder } = require('@msgpack/msgpack')
const { realNow } = require('../time/install')

const HEADER = 4
// Two seconds of frames.
const MAX_UNSENT = 40
// Interval of heartbeats in real time, because Python measures its patience in real time.
const BEAT_MS = 1000

/** Encoder that replaces lone surrogates by U+FFFD in every text, because Python refuses them. */
class WellFormedEncoder extends Encoder {
  encodeString (text) {
    super.encodeString(text.toWellFormed())
  }
}

class Channel {
  /**
   * Read messages from a stream.
   * @param {import('node:stream').Duplex} stream
   * @param {(message: object) => void} receive called with every message
   */
  constructor (stream, receive) {
    this.stream = stream
    this.receive = receive
    this.pending = Buffer.alloc(0)
    this.unsent = []
    this.written = 0
    this.encoder = new WellFormedEncoder({ ignoreUndefined: true })
    stream.on('data', chunk => this.take(chunk))
  }

  /** Send a message at once, together with those that `post` has queued. */
  send (message) {
    this.post(message)
    this.flush()
  }

  /** Queue a message to be sent soon: sending several together costs far less than sending each alone. */
  post (message) {
    const body = this.encoder.encodeSharedRef(message)
    const packet = Buffer.allocUnsafe(HEADER + body.length)
    packet.writeUInt32BE(body.length, 0)
    packet.set(body, HEADER)
    this.unsent.push(packet)
    if (this.unsent.length >= MAX_UNSENT) this.flush()
  }

  /** Send a message, and those that `post` has queued, if nothing was sent for a second. */
  beat (message) {
    if (realNow() - this.written >= BEAT_MS) this.send(message)
  }

  flush () {
    this.written = realNow()
    this.stream.write(Buffer.concat(this.unsent))
    this.unsent.length = 0
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
