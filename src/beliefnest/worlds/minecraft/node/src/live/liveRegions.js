'use strict'
/**
 * Real world of the embedded server in real time: one region, which people can enter and whose time continues between
 * calls. Each call first reports the events since the previous one.
 */
const { waitFor } = require('../bots/ticking')
const { BadRequest } = require('../channel/errors')
const { Regions } = require('../regions/regions')
const { LiveBodies } = require('./liveBodies')
const { LiveClock } = require('./liveClock')

const NOTHING = new Uint8Array(0)
// People see the server's coordinates; with this origin they equal the scenario's.
const AT_ORIGIN = { take: () => ({ x: 0, z: 0 }), giveBack () {} }

class LiveRegions extends Regions {
  /**
   * @param {object} serv
   * @param {(frame: object) => void} send called with every frame, while a call runs
   */
  constructor (serv, send) {
    super(serv, new LiveClock(() => this.open?.mail.scheduled ?? false), frame => this.take(frame))
    this.tell = send
    this.bodies = new LiveBodies(serv, this.clock)
    this.allotment = AT_ORIGIN
    this.open = null
    this.isDriven = false
    // Frames that no call has sent yet.
    this.waiting = []
    // Resolves when nobody works on the region any more.
    this.turn = Promise.resolve()
    this.failure = null
    // Resolves when time may go on; null while it does.
    this.standstill = null
    // Called at every tick with the region.
    this.onTick = () => {}
    // Called with every frame, and when frames that were reported are discarded.
    this.onFrame = () => {}
    this.onForget = () => {}
    // Resolves when nobody is entering or leaving.
    this.door = Promise.resolve()
    serv.on('tick', (_, __, region) => this.onTick(region))
  }

  /** Return the function with which skills wait for ticks of the region (bots/ticking.js). @returns {Function} */
  waitOf (region, bot, ended) {
    return waitFor(bot, () => region.tick, ended)
  }

  take (frame) {
    this.onFrame(frame)
    if (this.isDriven) this.tell(frame)
    else this.waiting.push(frame)
  }

  /** Run actions one after the other. */
  async alone (action) {
    const before = this.turn
    const { promise, resolve } = Promise.withResolvers()
    this.turn = promise
    await before
    try {
      return await action()
    } finally {
      resolve()
    }
  }

  async inside (region, action) {
    this.serv.region = region
    const result = await action()
    region.raiseFaults()
    return result
  }

  async create (request) {
    if (this.open !== null) throw new BadRequest(`${this.open.name} runs in real time; there can be one such region at a time`)
    this.failure = null
    const made = await super.create(request)
    this.goOn(this.open)
    return made
  }

  /** Set the open region, at the moment from which people can enter it. */
  async restoreState (region, internalState) {
    this.open = region
    await super.restoreState(region, internalState)
  }

  /** Advance time between calls. */
  async goOn (region) {
    this.clock.due = performance.now()
    while (this.open === region && this.failure === null) {
      if (this.standstill !== null) {
        await this.standstill.promise
        this.clock.due = performance.now()
      }
      await this.alone(() => this.open === region && this.standstill === null ? this.tick(region) : null).catch(error => { this.failure = error })
    }
  }

  /** Stop or resume time. @returns {Promise<boolean>} true if that changed anything */
  async pause (isPaused) {
    return this.alone(() => {
      if (isPaused === (this.standstill !== null)) return false
      this.standstill?.resolve()
      this.standstill = isPaused ? Promise.withResolvers() : null
      return true
    })
  }

  /** Run a call on the region. The call itself then advances the ticks. */
  async resumed (region, action) {
    return this.alone(async () => {
      if (this.failure !== null) throw this.failure
      region.faults.length = 0
      this.isDriven = true
      try {
        for (const frame of this.waiting.splice(0)) this.tell(frame)
        region.recorder.forgetClaims()
        await action()
        return { tick: region.tick, internal_state: NOTHING }
      } finally {
        this.isDriven = false
      }
    })
  }

  /** Set the region's state. Events since the last call are forgotten, with all their effects. */
  async apply (request) {
    await this.door
    return this.alone(async () => {
      const made = await super.apply(request)
      this.waiting.length = 0
      this.onForget()
      if (this.failure !== null) {
        this.failure = null
        this.goOn(this.open)
      }
      return made
    })
  }

  async destroy (name) {
    const region = this.get(name)
    await this.door
    return this.alone(async () => {
      this.open = null
      this.waiting.length = 0
      this.onForget()
      for (const { player } of region.bodies.values()) player._client.end('What was played here is over')
      await super.destroy(region.name)
    })
  }

  /** Return an empty internal state: a region that runs on by itself has nothing to resume. */
  internalState () {
    return NOTHING
  }
}

module.exports = { LiveRegions }
