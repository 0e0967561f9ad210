'use strict'
/** Answers the channel's requests with a server elsewhere, in real time. */
const { RequestHandler } = require('../requestHandler')
const { RemoteRegions } = require('./remoteRegions')
const { beginSession } = require('./session')

// Real time: a request may wait for the server, and says meanwhile that it lives.
const BEAT_MS = 500

class RemoteHandler extends RequestHandler {
  async answer (request) {
    const beating = setInterval(() => this.beat({ beat: this.tick }), BEAT_MS)
    try {
      return await super.answer(request)
    } finally {
      clearInterval(beating)
    }
  }

  async open (registry, { server }) {
    const session = await beginSession(server)
    return new RemoteRegions(server, session, registry, frame => this.send({ frame }))
  }

  get tick () {
    return this.regions?.open?.region.tick ?? null
  }

  async perform (request) {
    const result = await super.perform(request)
    if (request.op === 'shutdown') await this.regions.close()
    return result
  }
}

module.exports = { RemoteHandler }
