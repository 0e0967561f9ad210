'use strict'
/**
 * Regions of a server whose players come over TCP and whose time is real. Any number of them exist at the same time:
 * an AsyncLocalStorage says to which one the running code belongs.
 */
const { AsyncLocalStorage } = require('node:async_hooks')
const { once } = require('node:events')
const { Allotment } = require('../../src/regions/allotment')
const { Box } = require('../../src/regions/box')
const { applyContainers, applyItems } = require('../../src/regions/changes')
const { buildColumns, dropColumns } = require('../../src/regions/columns')
const { agentState, factsOf } = require('../../src/regions/facts')
const { join, showWorld } = require('../../src/regions/joining')
const { Recorder } = require('../../src/regions/recorder')
const { Region, TICK_MS } = require('../../src/regions/region')
const { Terrain } = require('../../src/regions/terrain')
const { TcpEnd } = require('../../src/net/tcpEnd')
const { floor } = require('../harness')

class Places {
  /**
   * @param {object} serv server from createServer
   */
  constructor (serv) {
    this.serv = serv
    this.running = new AsyncLocalStorage()
    this.allotment = new Allotment()
    this.byName = new Map()
    this.expected = new Map()
    Object.defineProperty(serv, 'region', { get: () => this.running.getStore() ?? null })
    serv.blocks.on('change', ({ position, after }) => serv.region.recorder.blockChanged(position, after))
    serv.facts.on('event', event => serv.region.recorder.serverEvent({ ...event, actor: event.player.agent }))
  }

  inside (place, action) {
    return this.running.run(place.region, action)
  }

  get (name) {
    const place = this.byName.get(name)
    if (place === undefined) throw new Error(`there is no place ${name}`)
    return place
  }

  /**
   * Make a place with a stone floor, which its agents can join.
   * @param {object} setting name `place`, `box`, `blocks` as [x, y, z, name, properties], `containers`, `agents` AGENT
   *   by name, `players` name on the server by agent
   * @returns {{x: number, z: number}} server position of scenario (0, y, 0)
   */
  create ({ place: name, box: corners, blocks, containers, agents, players }) {
    const { serv } = this
    const box = new Box(...corners)
    const origin = this.allotment.take(box)
    const region = new Region({ name, seed: name, box, origin, tick: 0 })
    region.recorder = new Recorder(region, factsOf(serv, region))
    const place = { region, events: [], players: new Map() }
    this.byName.set(name, place)
    for (const [agent, player] of Object.entries(players)) this.expected.set(player, { place, agent, state: agents[agent] })
    this.inside(place, () => {
      const states = blocks.map(([x, y, z, block, properties]) => [x, y, z, serv.blocks.state(block, properties)])
      buildColumns(serv, region, Terrain.read(floor(states, corners), box))
      applyContainers(serv, region, containers)
      applyItems(serv, region, {})
    })
    return { x: origin.x, z: origin.z }
  }

  /** Let the player of a connection join. */
  join (client) {
    const guest = this.expected.get(client.username)
    if (guest === undefined) return client.end(`nobody called ${client.username} is expected`)
    const { place, agent, state } = guest
    const { region } = place
    const inside = action => this.inside(place, action)
    return inside(() => {
      const end = new TcpEnd(client, inside, error => region.faults.push({ error, agent }))
      const player = join(this.serv, region, end, state)
      player.agent = agent
      showWorld(player, region.columns)
      player.setPossessions(state)
      player.updateHealth(state.health)
      place.players.set(agent, player)
    })
  }

  /** Run one tick of all places. */
  tick () {
    for (const place of this.byName.values()) this.inside(place, () => this.tickPlace(place))
  }

  tickPlace ({ region, events }) {
    const { serv } = this
    region.tick += 1
    serv.tickCount = region.tick
    serv.tickRegion(position => region.contains(position))
    serv.emit('tick', TICK_MS / 1000, region.tick, region)
    const frame = region.recorder.frame()
    if (frame !== null) events.push(...frame.events)
  }

  /** Resolve when all packets that the place's clients sent before they learn of this call have been handled. */
  async settled (place) {
    await Promise.all([...place.players.values()].map(({ _client }) => {
      if (_client.client.ended) return null
      const answered = Promise.race([once(_client, 'pong'), once(_client, 'end')])
      _client.write('ping', { id: place.region.tick })
      return answered
    }))
  }

  /** Let ticks pass. All earlier packets arrive before them, all later ones after them. */
  async pass (place, ticks) {
    await this.settled(place)
    const last = place.region.tick + ticks
    await new Promise(resolve => {
      const look = () => {
        if (place.region.tick < last) return
        this.serv.off('tick', look)
        resolve()
      }
      this.serv.on('tick', look)
      look()
    })
    await this.settled(place)
  }

  agent (place, name) {
    return this.inside(place, () => agentState(place.region, place.players.get(name)))
  }

  async destroy (name) {
    const place = this.get(name)
    await Promise.all([...place.players.values()].map(({ _client }) => {
      if (_client.client.ended) return null
      const ended = once(_client, 'end')
      _client.end('the place is given up')
      return ended
    }))
    this.inside(place, () => this.serv.forgetRegion(position => place.region.contains(position)))
    for (const player of place.players.values()) this.expected.delete(player.username)
    dropColumns(this.serv, place.region)
    this.allotment.giveBack(place.region.origin)
    this.byName.delete(name)
    place.region.raiseFaults()
  }
}

module.exports = { Places, TICK_MS }
