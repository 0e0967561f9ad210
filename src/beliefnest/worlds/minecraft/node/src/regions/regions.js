'use strict'
/** All regions of the world: creating, changing, reading and removing regions. */
const { decode, encode } = require('@msgpack/msgpack')
const { Allotment } = require('./allotment')
const { Bodies } = require('./bodies')
const { Box } = require('./box')
const { buildColumns, dropColumns } = require('./columns')
const { applyBlocks, applyContainers, applyItems, applySigns } = require('./changes')
const { agentStates, containerStates, factsOf, itemStates, settleItems, signStates } = require('./facts')
const { Recorder } = require('./recorder')
const { Region, TICK_MS } = require('./region')
const { Terrain } = require('./terrain')
const { BadRequest } = require('../channel/errors')

class Regions {
  /**
   * @param {object} serv
   * @param {import('../time/clock').Clock} clock
   * @param {(frame: object) => void} send called with every frame
   * @param {() => void} [alive] called after every tick
   */
  constructor (serv, clock, send, alive = () => {}) {
    this.serv = serv
    this.clock = clock
    this.send = send
    this.alive = alive
    this.allotment = new Allotment()
    this.bodies = new Bodies(serv, clock)
    this.bodies.keepSpeeds()
    this.byName = new Map()
    serv.blocks.on('change', ({ position, after }) => {
      serv.region.noteChange(position)
      serv.region.recorder.blockChanged(position, after)
    })
    serv.signs.on('change', ({ position, text, player }) => serv.region.recorder.signChanged(
      position, serv.blocks.at(position).stateId, text, player?.username ?? null))
    serv.facts.on('event', event => serv.region.recorder.serverEvent(event))
  }

  /** Return a region by name. @throws {BadRequest} if there is no such region */
  get (name) {
    const region = this.byName.get(name)
    if (region === undefined) {
      throw new BadRequest(`there is no region ${name}; there are: ${[...this.byName.keys()].join(', ') || 'none'}`)
    }
    return region
  }

  /** Run `action` in a region: with its clock, its random numbers and its part of the server. */
  async inside (region, action) {
    this.serv.region = region
    try {
      const result = await this.clock.within(region.context, action)
      region.raiseFaults()
      return result
    } finally {
      this.serv.region = null
    }
  }

  /** Create a region. Resolve when every bot stands in it. @returns {Promise<object>} SNAPSHOT of the new region */
  async create ({ region: name, seed, box: corners, tick, blocks, containers, agents, items, internal_state: internalState, signs = [], known: agentNames = Object.keys(agents) }) {
    if (this.byName.has(name)) throw new BadRequest(`there already is a region ${name}`)
    const box = new Box(...corners)
    requireHeight(this.serv, box)
    const terrain = Terrain.read(blocks, box)
    const region = new Region({ name, seed, box, origin: this.allotment.take(box), tick, agentNames })
    region.recorder = new Recorder(region, factsOf(this.serv, region))
    this.byName.set(name, region)
    try {
      await this.inside(region, async () => {
        buildColumns(this.serv, region, terrain)
        applyContainers(this.serv, region, containers)
        applySigns(this.serv, region, signs)
        await this.bodies.add(region, agents)
        applyItems(this.serv, region, items)
        await this.restoreState(region, internalState)
      })
    } catch (error) {
      await this.destroy(name)
      throw error
    }
    return this.snapshot(region)
  }

  /** Set the state of a region. @returns {Promise<object>} SNAPSHOT of the region in its new state */
  async apply ({ region: name, blocks, containers, agents, items, tick, internal_state: internalState, signs = [] }) {
    const region = this.get(name)
    await this.inside(region, async () => {
      applyBlocks(this.serv, region, blocks)
      applyContainers(this.serv, region, containers)
      applySigns(this.serv, region, signs)
      await this.bodies.apply(region, agents)
      region.tick = tick
      applyItems(this.serv, region, items)
      await this.restoreState(region, internalState)
    })
    return this.snapshot(region)
  }

  /**
   * Restore the internal state of a region that has the state of its SNAPSHOT; null means that nothing is in progress.
   */
  async restoreState (region, internalState) {
    this.serv.restoreState(region, internalState?.byteLength > 0 ? decode(internalState) : {})
    await this.clock.advance(0)
    region.context.setDate(region.tick * TICK_MS)
    region.recorder.settle()
  }

  /**
   * Return the state of processes in a region that its SNAPSHOT does not contain; empty if there are none.
   * @returns {Uint8Array}
   */
  internalState (region) {
    const parts = this.serv.internalState(region)
    return Object.keys(parts).length === 0 ? new Uint8Array(0) : encode(parts)
  }

  async destroy (name) {
    const region = this.get(name)
    await this.inside(region, () => {
      for (const agent of [...region.bodies.keys()]) this.bodies.remove(region, agent)
      this.serv.forgetRegion(position => region.contains(position))
    })
    region.context.timers.clear()
    dropColumns(this.serv, region)
    this.allotment.giveBack(region.origin)
    this.byName.delete(name)
  }

  /**
   * Run `action` in a region. Reset it before to the state of a region that was created from its snapshot: neither a
   * restart of the process nor a visit to another branch then affects what follows.
   * @returns {Promise<{tick: number, internal_state: Uint8Array}>}
   */
  async resumed (region, action) {
    return this.inside(region, async () => {
      region.reseed()
      region.recorder.forgetClaims()
      this.serv.numberItems()
      settleItems(this.serv, region)
      await this.bodies.settle(region)
      await action()
      return { tick: region.tick, internal_state: this.internalState(region) }
    })
  }

  /**
   * Advance the active region by one tick; send its frame if anything changed.
   * @param {() => Promise<void>} [before] called before the frame is made
   * @returns {Promise<boolean>} true if anything changed
   */
  async tick (region, before) {
    await this.clock.advance(TICK_MS)
    region.tick += 1
    this.serv.tickCount = region.tick
    this.serv.tickRegion(position => region.contains(position))
    this.serv.emit('tick', TICK_MS / 1000, region.tick, region)
    await this.clock.advance(0)
    await before?.()
    const frame = region.recorder.frame()
    if (frame !== null) this.send(frame)
    this.alive()
    region.reseed()
    region.raiseFaults()
    return frame !== null
  }

  async step (name, ticks) {
    const region = this.get(name)
    return this.resumed(region, async () => {
      for (let count = 0; count < ticks; count++) await this.tick(region)
    })
  }

  /** Return the SNAPSHOT of a region. @returns {Promise<object>} */
  async snapshot (region) {
    return this.inside(region, () => {
      return {
        tick: region.tick,
        changes: region.takeChanges(position => this.serv.overworld.sync.getBlockStateId(position)),
        containers: containerStates(this.serv, region),
        signs: signStates(this.serv, region),
        agents: agentStates(this.serv, region),
        items: itemStates(this.serv, region),
        internal_state: this.internalState(region)
      }
    })
  }
}

// The walls need one more layer below and above the box.
function requireHeight ({ minY, worldHeight }, box) {
  const [lowest, highest] = [minY + 1, minY + worldHeight - 2]
  if (box.low[1] >= lowest && box.high[1] <= highest) return
  throw new BadRequest(`a box lies between y = ${lowest} and y = ${highest}; this one goes from ${box.low[1]} to ${box.high[1]}`)
}

module.exports = { Regions, TICK_MS }
