'use strict'
/** Answers the channel's requests with the embedded server in real time, where people are agents as well. */
const { RealtimeHandler, requireBots } = require('../realtimeHandler')
const { createServer } = require('../server')
const { Door } = require('./door')
const { LiveRegions } = require('./liveRegions')

class LiveHandler extends RealtimeHandler {
  async open (registry, { listen }) {
    const regions = new LiveRegions(createServer(registry), frame => this.send({ frame }))
    this.door = new Door(regions)
    this.port = await this.door.listen(listen)
    return regions
  }

  get tick () {
    return this.regions?.open?.tick ?? null
  }

  async perform (request) {
    if (request.op === 'people') return { here: this.door.invite(request.invited), port: this.port }
    if (request.op === 'exhibit') return this.door.gallery.open(request) ?? null
    if (request.op === 'lags') return this.door.gallery.lags()
    if (request.op === 'close_exhibit') return this.door.closeExhibit(request.exhibit) ?? null
    if (request.op === 'run') requireBots(this.door.invited, Object.keys(request.programs))
    return super.perform(request)
  }

  note (message) {
    this.door.gallery.show(message, this.tick)
  }
}

module.exports = { LiveHandler }
