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
    this.parts = []
    this.received = 0
    this.needed = HEADER
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
    this.parts.push(chunk)
    this.received += chunk.length
    // Join the parts only when they complete a message: a large one arrives in many.
    if (this.received < this.needed) return
    let pending = this.parts.length === 1 ? chunk : Buffer.concat(this.parts)
    for (;;) {
      this.needed = pending.length < HEADER ? HEADER : HEADER + pending.readUInt32BE(0)
      if (pending.length < this.needed) break
      const body = pending.subarray(HEADER, this.needed)
      pending = pending.subarray(this.needed)
      this.receive(decode(body))
    }
    this.parts = [pending]
    this.received = pending.length
  }
}

module.exports = { Channel }
