'use strict'
const { RequestHandler } = require('./requestHandler')

const BEAT_MS = 500

/** Answers requests in real time: one may wait for a tick or for a server, and Node says meanwhile that it lives. */
class RealtimeHandler extends RequestHandler {
  async answer (request) {
    const beating = setInterval(() => this.beat({ beat: this.tick }), BEAT_MS)
    try {
      return await super.answer(request)
    } finally {
      clearInterval(beating)
    }
  }
}

module.exports = { RealtimeHandler }
