'use strict'
/** Handler of the channel's requests for a remote server, in real time. */
const { RealtimeHandler, requireBots } = require('../realtimeHandler')
const { capture } = require('./capture')
const { RemoteExhibits } = require('./remoteExhibits')
const { RemoteRegions } = require('./remoteRegions')
const { beginSession } = require('./session')

class RemoteHandler extends RealtimeHandler {
  async open (registry, { server }) {
    const session = await beginSession(server, notice => this.send({ notice }))
    this.capture = ({ box, cut }) => capture({ ...session, registry }, { x: server.at[0], z: server.at[1] }, box, cut)
    const regions = new RemoteRegions(server, session, registry, frame => this.send({ frame }))
    this.exhibits = new RemoteExhibits(regions)
    return regions
  }

  async hello (request) {
    return { ...await super.hello(request), minecraft_server: this.regions.version }
  }

  get tick () {
    return this.regions?.open?.region.tick ?? null
  }

  note (message) {
    this.exhibits.show(message, this.tick)
  }

  async perform (request) {
    if (request.op === 'capture') return this.capture(request)
    if (request.op === 'people') return { here: this.regions.invite(request.invited) }
    if (request.op === 'run') requireBots(this.regions.invited, Object.keys(request.programs))
    if (request.op === 'exhibit') return this.exhibits.open(request)
    if (request.op === 'close_exhibit') return this.exhibits.close(request.exhibit)
    if (request.op === 'lags') return this.exhibits.lags()
    if (request.op === 'shutdown') await this.exhibits.closeAll()
    const result = await super.perform(request)
    if (request.op === 'shutdown') await this.regions.close()
    return result
  }
}

module.exports = { RemoteHandler }
