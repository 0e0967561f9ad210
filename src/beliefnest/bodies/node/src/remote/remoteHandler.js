'use strict'
/** Answers the channel's requests with a server elsewhere, in real time. */
const { RealtimeHandler } = require('../realtimeHandler')
const { RemoteRegions } = require('./remoteRegions')
const { beginSession } = require('./session')

class RemoteHandler extends RealtimeHandler {
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
