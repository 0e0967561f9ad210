'use strict'
/**
 * Real world on a remote server, with the same interface as the regions of the embedded world. It has one region, whose
 * time continues between calls. Each call first reports the events since the previous one.
 */
const { setTimeout: sleep } = require('node:timers/promises')
const { BadRequest } = require('../channel/errors')
const { waitFor } = require('../bots/ticking')
const { Box } = require('../regions/box')
const { Terrain } = require('../regions/terrain')
const { Recorder } = require('../regions/recorder')
const { vecOf } = require('../server/plugins/lib/positions')
const { Agents } = require('./agents')
const { commandsFor } = require('./commands')
const { connect } = require('./connection')
const { RemotePlace } = require('./remotePlace')
const { Scene } = require('./scene')
const { Setup } = require('./setup')
const { BlockMapping } = require('./versions')

const POLL_MS = 5
const NOTHING = new Uint8Array(0)

class RemoteRegions {
  /**
   * @param {object} server `host`, `port`, `operator`, `at` (server position of scenario (0, 0): x, z), `overwrite`,
   *   `keep`, `patience` (s)
   * @param {object} session result of beginSession
   * @param {object} registry
   * @param {(frame: object) => void} send
   */
  constructor (server, { operator, clock, version, theirs }, registry, send) {
    this.server = server
    this.operator = operator
    this.serverClock = clock
    this.version = version
    this.registry = theirs
    this.mapping = new BlockMapping(registry, theirs)
    this.send = send
    this.open = null
    // Agents whose places people may take.
    this.invited = new Set()
    // Our own players that agents must not see.
    this.unseen = new Set([server.operator])
    // Reason why the place was given up; null while it is played.
    this.failure = null
    // Interface for a Runner. It does not wait until bots stand still, because the server's time continues anyway.
    this.bodies = {
      async rest () {},
      stand: async () => true,
      finish: (_, agents) => this.open.agents.rest(agents).catch(error => this.fail(error))
    }
    this.clock = { advance: () => new Promise(resolve => { setImmediate(resolve) }) }
  }

  /** Return the function with which skills wait for ticks of the server (bots/ticking.js). @returns {Function} */
  waitOf (region, bot, ended) {
    return waitFor(bot, () => region.followed, ended)
  }

  /** Return the region. @throws {BadRequest} if there is no such region */
  get (name) {
    if (this.open?.region.name !== name) throw new BadRequest(`there is no region ${name} on this server`)
    return this.open.region
  }

  /** Create a region. Resolve when every agent stands in it. @returns {Promise<object>} SNAPSHOT */
  async create ({ region: name, box: corners, tick, blocks, containers, agents, items, signs = [], known: agentNames = Object.keys(agents) }) {
    if (this.failure !== null) throw this.failure
    if (this.open !== null) throw new BadRequest(`${this.open.region.name} is played on this server; there can be one place at a time`)
    const [x, z] = this.server.at
    const region = new RemotePlace({ name, box: new Box(...corners), origin: { x, z }, tick, agentNames }, this.serverClock)
    this.server.agents = Object.keys(agents)
    this.open = this.equip(region)
    try {
      await this.make(() => this.fill(this.open, { blocks, containers, agents, items, signs }))
      this.begin(this.open, tick, agents)
    } catch (error) {
      await this.giveUp(this.open).catch(() => {})
      throw error
    }
    return this.snapshot(region)
  }

  /** Run an action of the set-up; stop as soon as the connection is lost. @throws {Unplayable} if it is lost */
  async make (action) {
    try {
      return await this.operator.attended(action)
    } catch (error) {
      if (!this.operator.link.isReady) this.failure ??= error
      throw error
    }
  }

  /** Begin a player's connection. @param {{x: number, z: number}} origin server position of the player's (0, y, 0) */
  connection (username, origin) {
    const { version, server, unseen: hidden } = this
    return connect({ host: server.host, port: server.port, version, username, origin, hidden, login: server.loginOf(username) })
  }

  /**
   * Return the objects that set up a place of the server and follow it.
   * @param {import('./operator').Operator} operator operator, or a guide in its place
   * @param {(error: Error) => void} fail called if contents cannot be read
   */
  tools (place, operator, fail) {
    const commands = commandsFor(place, state => this.mapping.textForServer(state), this.registry.version)
    const scene = new Scene(place, this.mapping, operator, commands, position => setup.asked(position).then(items => items ?? setup.read(position)))
    scene.fail = fail
    const setup = new Setup(scene, operator, commands, this.registry)
    return { scene, commands, setup }
  }

  equip (region) {
    const { operator, registry, mapping: { states } } = this
    const { scene, commands, setup } = this.tools(region, operator, error => { this.failure ??= error })
    const agents = new Agents(scene, operator, commands, registry, agent => this.connection(agent, region.origin), this.invited)
    const { contents, items } = scene
    region.recorder = new Recorder(region, {
      agents: () => agents.states(), items: () => items.states(), changedContainers: () => contents.drain(), blockText: state => states.text(state), signText: ([x, y, z]) => scene.signText({ x, y, z })
    })
    return { region, scene, setup, agents, saved: null, attach: (bot, client) => scene.attach(bot, client) }
  }

  async fill (open, { blocks, containers, agents, items, signs }) {
    const { region, scene, setup } = open
    const wanted = Terrain.read(blocks, region.box).dense()
    await setup.arrive()
    const { link, bot } = this.operator
    open.attach(bot, bot._client)
    link.on('begun', open.attach)
    const present = setup.present()
    if (!this.server.overwrite) setup.requireFree(present, wanted)
    open.saved = await this.save(open, present)
    const built = await setup.build(wanted)
    scene.settle(Terrain.of(built, region.box))
    await setup.stock(withEmpty(setup.containers(scene.blocks), containers))
    await setup.write(signs)
    await setup.lay(items)
    await open.agents.add(agents, this.server.patience * 1000)
    const [someone] = open.agents.bots()
    if (someone !== undefined) await setup.requireUse(someone)
  }

  async save ({ scene, setup }, present) {
    scene.settle(Terrain.of(present.slice(), scene.region.box))
    const containers = []
    for (const position of setup.containers(scene.blocks)) containers.push([...position, await setup.read(position) ?? {}])
    return { states: present, containers }
  }

  /** Begin to report events. */
  begin (open, tick, agents) {
    const { region } = open
    region.rebase(tick)
    this.know(open, agents)
    this.operator.link.arrive = () => this.lookAgain(open)
    region.pulse = setInterval(() => this.tickUndriven(open), POLL_MS)
  }

  /** Take the requested state as known; the next frame reports where the server differs from it. */
  know ({ region, scene }, agents) {
    scene.endTick()
    region.recorder.settle()
    for (const [agent, state] of Object.entries(agents)) if (state !== null) region.recorder.reported.agents.set(agent, state)
  }

  /** Find the blocks that changed while the operator was disconnected, by comparing all of them. */
  async lookAgain ({ region, scene, setup }) {
    await setup.arrive()
    const present = setup.present()
    region.box.forEach((x, y, z, index) => scene.blockChanged(vecOf({ x, y, z }), present[index]))
  }

  tickUndriven (open) {
    const { region } = open
    if (region.isDriven || region.now() <= region.tick) return
    region.tick = region.now()
    this.makeFrame(open)
  }

  /** Make the frame of a tick. @returns {boolean} true if anything has changed */
  makeFrame ({ region, scene, agents }) {
    scene.endTick()
    agents.endTick()
    const frame = region.recorder.frame()
    if (frame === null) return false
    if (region.isDriven) this.send(frame)
    else region.waiting.push(frame)
    return true
  }

  /** Run a call on a region. The call itself then advances the ticks. */
  async resumed (region, action) {
    await this.present()
    region.faults.length = 0
    region.isDriven = true
    try {
      for (const frame of region.waiting.splice(0)) this.send(frame)
      region.recorder.forgetClaims()
      await action()
      return { tick: region.tick, internal_state: NOTHING }
    } finally {
      region.isDriven = false
    }
  }

  /**
   * Set the agents whose places people may take; kick people who play other agents.
   * @returns {string[]} agents that people play now
   */
  invite (names) {
    this.invited.clear()
    for (const name of names) this.invited.add(name)
    return this.open === null ? [] : this.open.agents.invite()
  }

  /** Wait for the next tick and send its frame. @returns {Promise<boolean>} true if anything has changed */
  async tick (region, before) {
    while (region.now() <= region.tick) {
      try {
        this.operator.requireServer()
      } catch (error) {
        this.fail(error)
      }
      await sleep(POLL_MS)
    }
    region.tick = region.now()
    await before?.()
    region.tick = region.now()
    return this.makeFrame(this.open)
  }

  fail (error) {
    this.failure = error
    throw error
  }

  /** Resolve when all players are connected. @throws {Unplayable} if the place was given up or must be given up */
  async present () {
    if (this.failure !== null) throw this.failure
    await this.open.agents.present().catch(error => this.fail(error))
  }

  async step (name, ticks) {
    const region = this.get(name)
    return this.resumed(region, async () => {
      const last = region.tick + ticks
      while (region.tick < last) await this.tick(region)
    })
  }

  /** Set the region's state. Events since the last call are forgotten, with all their effects. */
  async apply ({ region: name, blocks, containers, agents, items, tick, signs = [] }) {
    const region = this.get(name)
    region.isDriven = true
    try {
      await this.present()
      await this.make(() => this.change(this.open, { blocks, containers, agents, items, signs }))
      region.waiting.length = 0
      region.rebase(tick)
      this.know(this.open, agents)
    } finally {
      region.isDriven = false
    }
    return this.snapshot(region)
  }

  async change ({ region, scene, setup, agents: present }, { blocks, containers, agents, items, signs }) {
    const wanted = scene.blocks.dense().slice()
    for (const [x, y, z, state] of blocks) wanted[region.box.index(x, y, z)] = state
    scene.settle(Terrain.of(await setup.build(wanted), region.box))
    for (const position of blocks.map(([x, y, z]) => vecOf({ x, y, z }))) scene.replaced(position, scene.at(position))
    await setup.stock(containers.filter(([, , , items]) => items !== null))
    await setup.write(signs)
    await setup.lay(items)
    await this.moveAgents(present, agents)
  }

  async moveAgents (present, agents) {
    const gone = Object.keys(agents).filter(agent => agents[agent] === null)
    for (const agent of gone) await present.remove(agent)
    const wanted = Object.entries(agents).filter(([, state]) => state !== null)
    const come = wanted.filter(([agent]) => !present.links.has(agent))
    await present.place(Object.fromEntries(wanted.filter(([agent]) => present.links.has(agent))))
    if (come.length > 0) await present.add(Object.fromEntries(come), this.server.patience * 1000)
  }

  async destroy (name) {
    this.get(name)
    await this.giveUp(this.open)
    // A session whose place was given up cannot continue.
    if (this.failure !== null) throw this.failure
  }

  /** Remove all agents, and restore the blocks that were there before unless the new ones are to be kept. */
  async giveUp (open) {
    const { region, agents, saved } = open
    clearInterval(region.pulse)
    this.operator.link.arrive = async () => {}
    this.operator.link.off('begun', open.attach)
    this.open = null
    await agents.close()
    if (saved === null || this.failure !== null || !this.operator.link.isHere) return
    await this.operator.attended(() => this.putBack(open))
  }

  async putBack ({ scene, setup, saved }) {
    if (!this.server.keep) {
      await setup.lay({})
      scene.settle(Terrain.of(await setup.build(saved.states), scene.region.box))
      await setup.stock(saved.containers)
    }
    this.operator.type(setup.commands.load('remove'))
    await this.operator.settled()
  }

  /** Return the SNAPSHOT of the present state. @returns {object} */
  snapshot ({ tick }) {
    const { scene, agents } = this.open
    return {
      tick, blocks: scene.blocks.message(), containers: scene.contents.states(), agents: agents.states(), items: scene.items.states(), internal_state: NOTHING, signs: scene.signStates()
    }
  }

  /** Close all connections. */
  async close () {
    if (this.open !== null) await this.giveUp(this.open)
    await this.operator.link.close()
  }
}

/** Return the contents of all containers of the box; those that are not mentioned are empty. */
function withEmpty (positions, containers) {
  const said = new Set(containers.map(([x, y, z]) => `${x},${y},${z}`))
  return [...containers, ...positions.filter(position => !said.has(position.join())).map(position => [...position, {}])]
}

module.exports = { RemoteRegions }
