'use strict'
/** Handler of the channel's requests for the embedded server in real time, where people can play agents. */
const { BadRequest } = require('../channel/errors')
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
    if (request.op === 'pause') return this.door.pause(request.paused).then(() => null)
    if (request.op === 'shutdown') await this.door.close()
    this.requireTime(request)
    if (request.op === 'run') requireBots(this.door.invited, Object.keys(request.programs))
    return super.perform(request)
  }

  /** Refuse a request that needs time while time stands still. @throws {BadRequest} if time stands still */
  requireTime ({ op, ticks }) {
    if (this.regions === null || this.regions.standstill === null || !(op === 'run' || (op === 'step' && ticks > 0))) return
    throw new BadRequest(`the real world stands still at tick ${this.tick}; let it go on first: nest.go_on()`)
  }

  note (message) {
    if (message.op === 'hear') this.door.earshot.hear(message)
    else if (message.op === 'hearing') this.door.earshot.isGlobal = message.global
    else this.door.gallery.show(message, this.tick)
  }
}

module.exports = { LiveHandler }
