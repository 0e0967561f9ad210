'use strict'
/** Handler of the channel's requests (design/channel.md), one at a time. */
const { Random } = require('./time/random')
const { rememberBlocks } = require('./blocks')
const { createServer } = require('./server')
const { readPlace } = require('./places/files')
const { Regions } = require('./regions/regions')
const { Runner } = require('./runner')
const { createSandbox } = require('./sandbox')
const { scopeOf } = require('./scope')
const { BadRequest } = require('./channel/errors')
const versions = require('./versions')

const PROTOCOL = 6

class RequestHandler {
  /**
   * @param {import('./time/clock').Clock} clock
   * @param {(message: object) => void} send sends a message
   * @param {(message: object) => void} [beat] called with each heartbeat
   * @param {(message: object) => Promise<object>} [ask] sends a question and resolves with the other side's reply
   */
  constructor (clock, send, beat = () => {}, ask = undefined) {
    this.clock = clock
    this.send = send
    this.beat = beat
    this.ask = ask
    this.regions = null
    this.runner = null
    this.sandbox = null
  }

  /** Return the reply to a request; failures are replies, too. @returns {Promise<object>} */
  async answer (request) {
    try {
      return { id: request.id, ok: true, result: await this.perform(request) }
    } catch (error) {
      const { message, kind = 'internal' } = error
      return { id: request.id, ok: false, error: { kind, message, stack: error.stack } }
    }
  }

  /** Prepare the next request while the other side works on the last reply. */
  async prepare () {
    await this.sandbox?.prepare()
  }

  async perform (request) {
    if (request.op === 'hello') return this.hello(request)
    if (this.regions === null) throw new BadRequest('the first request must be hello')
    switch (request.op) {
      case 'create_region': return this.regions.create(request)
      case 'destroy_region': return this.regions.destroy(request.region).then(() => null)
      case 'step': return this.regions.step(request.region, request.ticks)
      case 'run': return this.runner.run(request.region, request.programs, request.timeout_ticks, request.senses, rulesOf(request))
      case 'apply': return this.regions.apply(request)
      case 'snapshot': return this.regions.snapshot(this.regions.get(request.region))
      case 'read_place': return readPlace(request.bytes, request.cut)
      case 'shutdown': return null
      default: throw new BadRequest(`there is no operation ${request.op}`)
    }
  }

  async hello (request) {
    const { protocol, minecraft } = request
    if (protocol !== PROTOCOL) {
      throw new BadRequest(`protocol ${protocol} was asked for; this side speaks ${PROTOCOL}`)
    }
    if (minecraft !== versions.minecraft) {
      throw new BadRequest(`Minecraft ${minecraft} was asked for; this build has ${versions.minecraft}`)
    }
    const registry = require('prismarine-registry')(minecraft)
    registry.loadDimensionCodec(registry.loginPacket.dimensionCodec)
    rememberBlocks(registry)
    const alive = () => this.beat({ beat: this.tick })
    this.regions = await this.open(registry, request, alive)
    this.sandbox = createSandbox({}, alive)
    // Warm the sandbox with the names in scope, which are the same for every bot.
    await this.sandbox.warm(scopeOf({ registry }, () => {}))
    const perceive = async tick => (await this.ask({ perceive: tick })).percepts
    this.runner = new Runner(this.regions, request => this.sandbox.run(request), scopeOf, perceive)
    return { protocol: PROTOCOL, node: process.version, ...versions }
  }

  /** Return the regions of the world that `hello` asks for. @returns {Promise<object>} */
  async open (registry, { seed }, alive) {
    this.clock.root.random = new Random(String(seed))
    const serv = createServer(registry)
    return new Regions(serv, this.clock, frame => this.send({ frame }), alive)
  }

  /** Return the tick of the running region; null if none runs. */
  get tick () {
    return this.regions?.serv.region?.tick ?? null
  }
}

function rulesOf ({ speech_ticks: speechTicks = 0, remembers = false, past = {}, mute = [] }) {
  return { speechTicks, remembers, past, mute }
}

module.exports = { PROTOCOL, RequestHandler }
