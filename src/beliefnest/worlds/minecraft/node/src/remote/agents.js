'use strict'
/** Agents of a place on a remote server: their connections, and the commands that put them into their states. */
const { isDeepStrictEqual } = require('node:util')
const { BadRequest } = require('../channel/errors')
const { ground, stopBot } = require('../bots/bot')
const { layOut, possessionsOf } = require('../server/plugins/lib/slots')
const { wrap } = require('../server/angles')
const { rounded, sorted } = require('../regions/facts')
const { Link } = require('./link')
const { Witness } = require('./witness')

const NEAR = 0.02
const NEAR_PERSON = 0.3
const FULL = 20
// State of a person of whom nothing is known yet.
const NOBODY = { position: [0, 0, 0], yaw: 0, pitch: 0, on_ground: true, equipment: {}, inventory: {}, health: FULL, food: FULL }
const SLOTS = 46
const AT_ONCE = 8
const FIRST_HOTBAR = 36
// Number of ticks of the server.
const PLACING_TICKS = 200
const ASKED_EVERY_TICKS = 10
const COLUMNS_TICKS = 100
const RESULT = 0

class Agents {
  /**
   * @param {import('./scene').Scene} scene
   * @param {import('./operator').Operator} operator
   * @param {object} commands of commandsFor
   * @param {object} registry
   * @param {(agent: string) => object} connect begins the connection of an agent
   * @param {Set<string>} invited agents whose places people may take
   */
  constructor (scene, operator, commands, registry, connect, invited) {
    this.scene = scene
    this.region = scene.region
    this.operator = operator
    this.commands = commands
    this.registry = registry
    this.connect = connect
    this.invited = invited
    this.Item = require('prismarine-item')(registry)
    this.links = new Map()
    this.latest = new Map()
  }

  /** Let agents in, a few at the same time. */
  async add (agents, patienceMs) {
    const { operator } = this
    const players = Object.keys(operator.bot.players)
    for (const agent of Object.keys(agents)) {
      if (players.includes(agent) && !this.invited.has(agent)) throw new BadRequest(`a player called ${agent} is on the server already; end the other run, or give the agent another name`)
    }
    const names = Object.keys(agents).sort()
    // Servers may refuse players who join together with many others.
    for (let first = 0; first < names.length; first += AT_ONCE) {
      await Promise.all(names.slice(first, first + AT_ONCE).map(agent => this.enter(agent, players.includes(agent), patienceMs)))
    }
    await this.place(agents)
  }

  /** Let one agent in: as its bot, or as a person who is on the server already. */
  async enter (agent, isThere, patienceMs) {
    const { operator, region } = this
    const witness = new Witness(agent, region, this.scene, this.Item)
    this.scene.witnesses.set(agent, witness)
    witness.on('event', fact => { if (witness.person === null) this.scene.lids.account(fact) })
    const link = new Link(agent, () => this.connect(agent), operator.server, patienceMs, () => this.stand(agent))
    link.on('begun', (bot, client) => witness.attach(bot, client))
    link.on('lost', reason => region.faults.push({ agent, lost: reason }))
    link.on('yielded', () => this.yield(agent))
    link.isForPerson = this.invited.has(agent)
    this.links.set(agent, link)
    this.latest.delete(agent)
    if (isThere) link.yield()
    else await link.open()
    region.bodies.set(agent, { get bot () { return link.bot }, player: witness })
  }

  /** Let a person who has joined under an agent's name replace its bot. */
  yield (agent) {
    const latest = this.latest.get(agent) ?? NOBODY
    this.scene.people.come(this.scene.witnesses.get(agent), latest)
  }

  /** Return agents to their bots when their people have left. */
  endTick () {
    for (const agent of this.scene.people.endTick()) {
      this.scene.people.leave(agent)
      this.links.get(agent).takeBack()
    }
  }

  /** Kick people whose agents may no longer be played by people. @returns {string[]} agents that people play now */
  invite () {
    const { operator, commands } = this
    for (const [agent, link] of this.links) {
      link.isForPerson = this.invited.has(agent)
      if (!link.isYielded || link.isForPerson) continue
      if (!operator.can('kick')) throw new BadRequest(`this server has no /kick: ask who plays ${agent} to leave`)
      operator.type(commands.sendAway(agent))
    }
    return [...this.links].filter(([, link]) => link.isYielded && link.isForPerson).map(([agent]) => agent).sort()
  }

  /** Return the bots of agents that people do not play. @returns {object[]} */
  bots () {
    return [...this.links.values()].filter(({ isHere }) => isHere).map(({ bot }) => bot)
  }

  /** Remove an agent. */
  async remove (agent) {
    this.scene.people.leave(agent)
    const link = this.links.get(agent)
    this.links.delete(agent)
    this.latest.delete(agent)
    this.scene.witnesses.delete(agent)
    this.region.bodies.delete(agent)
    await link?.close()
  }

  /** Switch on the physics of a bot once its surroundings have arrived. */
  async stand (agent) {
    const { bot } = this.links.get(agent)
    if (!this.latest.has(agent)) return
    await this.sees(bot)
    bot.physicsEnabled = true
  }

  /** Put agents into their given positions and states. */
  async place (agents) {
    const { operator } = this
    const placing = Object.entries(agents)
    for (const [agent, state] of placing) this.command(agent, state)
    // Agents that were there before are moved all the same.
    await operator.settled()
    await Promise.all(placing.map(([agent]) => this.isPerson(agent) ? null : this.answered(agent)))
    await Promise.all(placing.map(([agent, state]) => this.arrived(agent, state)))
    for (const [agent, state] of placing) {
      if (!this.isPerson(agent)) this.settle(this.bot(agent), state)
      this.latest.set(agent, this.look(agent))
    }
  }

  /** Type the commands that move an agent and set its possessions. */
  command (agent, state) {
    const { operator, commands } = this
    const { health, food } = this.isPerson(agent) ? this.look(agent) : this.bot(agent)
    if (!this.isPerson(agent)) this.bot(agent).physicsEnabled = false
    operator.type(commands.mode(agent, 'survival'))
    operator.type(commands.clear(agent))
    this.slots(agent, state).forEach((stack, slot) => { if (stack) operator.type(commands.wear(agent, slot, stack)) })
    if (operator.can('effect') && health < FULL && state.health === FULL) operator.type(commands.heal(agent))
    if (operator.can('effect') && food < FULL && state.food === FULL) operator.type(commands.feed(agent))
    operator.type(commands.go(agent, state.position, state))
  }

  settle (bot, state) {
    bot.setQuickBarSlot(0)
    ground(bot, state.on_ground)
    bot.physicsEnabled = true
  }

  isPerson (agent) {
    return this.links.get(agent).isYielded
  }

  async arrived (agent, state) {
    const [x, y, z] = state.position
    const { witnesses, people } = this.scene
    const person = people.here.get(agent) ?? null
    const position = () => witnesses.get(agent).position
    // A client moves on by itself after a teleport, and others see its position in steps.
    const there = () => position().distanceTo({ x, y, z }) < (person === null ? NEAR : NEAR_PERSON)
    const has = () => isDeepStrictEqual(this.look(agent).inventory, sorted(state.inventory))
    const isDone = person === null || this.operator.can('data') ? () => there() && has() : there
    const { operator, operator: { clock } } = this
    const due = clock.followed + PLACING_TICKS
    await person?.ask()
    while (!await operator.until(isDone, ASKED_EVERY_TICKS) && clock.followed < due) await (person?.ask() ?? this.askSlots(agent))
    if (isDone()) {
      // Set this before any further wait, during which the bot may lose its connection.
      witnesses.get(agent).stoodAt = position().floored()
      if (person === null) await this.sees(this.bot(agent))
      return
    }
    const what = there() ? `has ${JSON.stringify(this.look(agent).inventory)} instead of ${JSON.stringify(state.inventory)}` : `is at ${position()} instead of (${state.position.join(', ')})`
    throw new BadRequest(`${agent} ${what} on the server; it said last: ${this.operator.lines.at(-1) ?? 'nothing'}`)
  }

  /**
   * Make the server resend a bot's whole inventory, as after an outdated click: single slots may have arrived wrong.
   */
  async askSlots (agent) {
    const { isHere, bot } = this.links.get(agent)
    if (isHere && !bot.currentWindow) bot._syncWindow(bot.inventory).catch(() => {})
  }

  /** Resolve when a bot has received the box, or the part of it that the server shows from there. */
  async sees (bot) {
    await this.operator.shown(bot, this.region.box, COLUMNS_TICKS)
    const here = bot.entity.position.toArray().map(Math.floor)
    await this.operator.shown(bot, { low: here, high: here }, PLACING_TICKS)
  }

  slots (agent, state) {
    try {
      return layOut({ Item: this.Item, registry: this.registry }, SLOTS, state, agent)
    } catch (error) {
      if (error instanceof RangeError) throw new BadRequest(error.message)
      throw error
    }
  }

  bot (agent) {
    return this.links.get(agent).bot
  }

  /** Return AGENT by name; for an absent agent its last state. @returns {object} */
  states () {
    for (const [agent, link] of this.links) if (link.isHere || link.isYielded) this.latest.set(agent, this.look(agent))
    return Object.fromEntries([...this.latest].sort(([a], [b]) => (a < b ? -1 : 1)))
  }

  look (agent) {
    if (this.isPerson(agent)) return this.scene.people.here.get(agent).state()
    const { entity, health, food, inventory, currentWindow, quickBarSlot } = this.bot(agent)
    const stacks = [currentWindow?.selectedItem ?? inventory.selectedItem, ...inventory.slots.slice(1)]
    if (currentWindow) {
      const shift = currentWindow.inventoryStart - inventory.inventoryStart
      for (let slot = inventory.inventoryStart; slot < inventory.inventoryEnd; slot++) stacks[slot] = currentWindow.slots[slot + shift]
    }
    stacks[RESULT] ??= null
    const possessions = possessionsOf(stacks, stacks[FIRST_HOTBAR + (quickBarSlot ?? 0)])
    const { x, y, z } = entity.position
    return {
      position: [x, y, z].map(rounded),
      yaw: rounded(wrap(entity.yaw)),
      pitch: rounded(wrap(entity.pitch)),
      on_ground: entity.onGround,
      equipment: possessions.equipment,
      inventory: sorted(possessions.inventory),
      health,
      food
    }
  }

  /**
   * End the acts of agents. Resolve when the server has handled all of them and the operator has seen the effects.
   * Wait for bots that were disconnected: only then it is known whether only the bot failed or the server has stopped.
   * @throws {Unplayable} if a bot does not come back
   */
  async rest (agents) {
    await this.present()
    for (const agent of agents) if (this.links.get(agent).isHere) stopBot(this.bot(agent))
    await this.settled()
    for (const agent of agents) this.scene.witnesses.get(agent).rest()
  }

  async settled () {
    const here = [...this.links.values()].filter(({ isHere }) => isHere)
    await Promise.all(here.map(({ name }) => this.answered(name)))
    const from = this.region.now()
    await this.operator.until(() => this.region.now() >= from + 2 || !this.operator.link.isHere)
    await this.operator.settled()
    await this.operator.until(() => this.scene.isQuiet)
  }

  /**
   * Resolve when the server has handled an agent's packets and the agent's client has received all earlier packets.
   */
  async answered (agent) {
    await this.operator.hasSettled(this.bot(agent), this.operator.patienceTicks)
  }

  /** Resolve when all agents and the operator are connected. @throws {Unplayable} if a connection was given up */
  async present () {
    for (const link of [this.operator.link, ...this.links.values()]) await link.present()
  }

  async close () {
    await Promise.all([...this.links.values()].map(link => link.close()))
    this.links.clear()
    this.scene.witnesses.clear()
    this.region.bodies.clear()
  }
}

module.exports = { Agents }
