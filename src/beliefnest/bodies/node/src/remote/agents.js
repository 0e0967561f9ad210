'use strict'
/** The agents of a place on a server elsewhere: their connections, and how they are put where they are to be. */
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
// Of a person of whom nothing is known yet.
const NOBODY = { position: [0, 0, 0], yaw: 0, pitch: 0, on_ground: true, equipment: {}, inventory: {}, health: FULL, food: FULL }
const SLOTS = 46
const AT_ONCE = 8
const FIRST_HOTBAR = 36
// Ticks of the server.
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
   * @param {(agent: string) => object} connect begins the connection of one
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
    // A server may turn away who comes with many others.
    for (let first = 0; first < names.length; first += AT_ONCE) {
      await Promise.all(names.slice(first, first + AT_ONCE).map(agent => this.enter(agent, players.includes(agent), patienceMs)))
    }
    await this.place(agents)
  }

  /** Let one agent in, by its bot or by a person who is there already. */
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

  /** A person has come in by an agent's name. */
  yield (agent) {
    const latest = this.latest.get(agent) ?? NOBODY
    this.scene.people.come(this.scene.witnesses.get(agent), latest)
  }

  /** Agents whose persons have left are bots again. */
  endTick () {
    for (const agent of this.scene.people.endTick()) {
      this.scene.people.leave(agent)
      this.links.get(agent).takeBack()
    }
  }

  /** Send away who may no longer be an agent. @returns {string[]} the agents who are people now */
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

  /** @returns {object[]} the bots of agents who are no people */
  bots () {
    return [...this.links.values()].filter(({ isHere }) => isHere).map(({ bot }) => bot)
  }

  /** Let an agent leave. */
  async remove (agent) {
    this.scene.people.leave(agent)
    const link = this.links.get(agent)
    this.links.delete(agent)
    this.latest.delete(agent)
    this.scene.witnesses.delete(agent)
    this.region.bodies.delete(agent)
    await link?.close()
  }

  /** Gravity holds for one who has come in once the ground is there. */
  async stand (agent) {
    const { bot } = this.links.get(agent)
    if (!this.latest.has(agent)) return
    await this.sees(bot)
    bot.physicsEnabled = true
  }

  /** Make agents be where, and have what, they are to. */
  async place (agents) {
    const { operator } = this
    const placing = Object.entries(agents)
    for (const [agent, state] of placing) this.command(agent, state)
    // One who was there before is moved all the same.
    await operator.settled()
    await Promise.all(placing.map(([agent]) => this.isPerson(agent) ? null : this.answered(agent)))
    await Promise.all(placing.map(([agent, state]) => this.arrived(agent, state)))
    for (const [agent, state] of placing) {
      if (!this.isPerson(agent)) this.settle(this.bot(agent), state)
      this.latest.set(agent, this.look(agent))
    }
  }

  /** Types what puts an agent where it is to be, with what it is to have. */
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
    // A client goes on by itself once it has been moved, and others see where it is in steps.
    const there = () => position().distanceTo({ x, y, z }) < (person === null ? NEAR : NEAR_PERSON)
    const has = () => isDeepStrictEqual(this.look(agent).inventory, sorted(state.inventory))
    const isDone = person === null || this.operator.can('data') ? () => there() && has() : there
    const { operator, operator: { clock } } = this
    const due = clock.age + PLACING_TICKS
    await person?.ask()
    while (!await operator.until(isDone, ASKED_EVERY_TICKS) && clock.age < due) await (person?.ask() ?? this.askSlots(agent))
    if (isDone()) {
      // Before anything else is waited for: it may lose its connection meanwhile.
      witnesses.get(agent).stoodAt = position().floored()
      if (person === null) await this.sees(this.bot(agent))
      return
    }
    const what = there() ? `has ${JSON.stringify(this.look(agent).inventory)} instead of ${JSON.stringify(state.inventory)}` : `is at ${position()} instead of (${state.position.join(', ')})`
    throw new BadRequest(`${agent} ${what} on the server; it said last: ${this.operator.lines.at(-1) ?? 'nothing'}`)
  }

  /** Has a bot shown all it has anew, as a server does for a click of long ago: what it was shown of single slots may be wrong. */
  async askSlots (agent) {
    const { isHere, bot } = this.links.get(agent)
    if (isHere && !bot.currentWindow) bot._syncWindow(bot.inventory).catch(() => {})
  }

  /** Resolve when a bot has been shown the box, or the part of it that the server shows from there. */
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

  /** @returns {object} AGENT by name; one who is away is as it was last */
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
   * End what agents were doing; resolves when all they did has been handled and seen. Bots that were cut off are waited for:
   * whether a program failed with its bot alone, or the server has ended, shows only then.
   * @throws {Unplayable} if one does not come back
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

  /** Resolve when the server has handled what an agent's client has sent, and the client what was sent to it before. */
  async answered (agent) {
    await this.operator.hasSettled(this.bot(agent), this.operator.patienceTicks)
  }

  /** Resolve when all agents and the operator are connected. @throws {Unplayable} if one was given up */
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
