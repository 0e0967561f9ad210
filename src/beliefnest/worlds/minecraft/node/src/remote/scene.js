'use strict'
/**
 * Events of a place on a remote server, as its operator sees and hears them: blocks, dropped items, words. The actor
 * of an effect is found among the attempts that agents have just made.
 */
const { Vec3 } = require('vec3')
const { halvesAt } = require('../server/plugins/lib/doubleChest')
const { handOver } = require('../server/plugins/lib/gifts')
const { byPlace, keyOf, listOf, vecOf } = require('../server/plugins/lib/positions')
const { without } = require('../server/plugins/lib/throws')
const { textOf } = require('../../../../../skills/code/lib/signs')
const { slotsIn } = require('./kinds')
const { Contents } = require('./contents')
const { Items } = require('./items')
const { Lids } = require('./lids')
const { People } = require('./people')

const BY_HAND = /(_door|_trapdoor|_fence_gate)$/
// Number of ticks after which words that nobody heard are given up.
const UNHEARD_AFTER = 60
// Number of ticks in which an item that appears where a block was mined counts as its drop.
const FALLS_WITHIN = 5
const LID = 1
// Number of ticks in which a swing of an arm may follow the effect of the act.
const SWINGS_WITHIN = 10

class Scene {
  /**
   * @param {import('../regions/place').Place} region
   * @param {import('./versions').BlockMapping} mapping
   * @param {import('./operator').Operator} operator
   * @param {object} commands of commandsFor
   * @param {(position: number[]) => Promise<object | null>} read returns the ITEMS of a container from the server's
   *   data
   */
  constructor (region, mapping, operator, commands, read) {
    this.region = region
    this.mapping = mapping
    this.states = mapping.states
    this.contents = new Contents()
    this.items = new Items(region)
    this.people = new People(region, operator, commands)
    this.lids = new Lids(this, read)
    // Called with the reason if the place can no longer be followed.
    this.fail = () => {}
    this.mined = []
    // Texts of the signs that have one.
    this.signs = new Map()
    this.witnesses = new Map()
    this.expected = []
    this.thrown = []
    // Acts on blocks in this tick; they are recorded after their effects.
    this.deeds = []
    // Effects that no bot has attempted and a person may have caused: {position, tick, tell}.
    this.unexplained = []
    this.blocks = null
    this.serv = servFor(this)
  }

  /** Set the known blocks of the box, a terrain that nobody else changes. */
  settle (terrain) {
    this.blocks = terrain
  }

  at ({ x, y, z }) {
    const { box } = this.region
    return this.states.describe(box.contains(x, y, z) ? this.blocks.at(x, y, z) : 0)
  }

  halvesAt (position) {
    return halvesAt(place => this.at(place), position)
  }

  /** Return the position of the container to which the block at a position belongs. */
  wholeAt (position) {
    return this.halvesAt(position)[0]
  }

  /** Handle a block of the box that became `state`. */
  blockChanged (position, state) {
    const { box, recorder } = this.region
    if (this.blocks === null || !box.contains(position.x, position.y, position.z)) return
    const { x, y, z } = position
    const old = this.blocks.at(x, y, z)
    if (old === state) return
    const before = this.states.describe(old)
    const after = this.states.describe(state)
    this.blocks.set(x, y, z, state)
    if (before.name !== after.name) this.replaced(position, after)
    recorder.blockChanged(this.region.toServer(listOf(position)), state)
    this.attribute(position, before, after)
  }

  replaced (position, after) {
    this.contents.forget(position)
    this.signs.delete(keyOf(position))
    if (slotsIn(after.name) > 0 && this.wholeAt(position).equals(position)) this.contents.know(position, {})
  }

  /** Handle the text that a sign now shows. */
  signShown (position, text) {
    const { box, recorder } = this.region
    if (this.blocks === null || !box.contains(position.x, position.y, position.z) || text === this.signText(position)) return
    this.writeDown(position, text)
    const writer = this.whoTried('write', position) ?? this.people.whoWrote(position)
    recorder.signChanged(this.region.toServer(listOf(position)), this.at(position).stateId, text, writer?.agent ?? null)
  }

  writeDown (position, text) {
    if (text === '') this.signs.delete(keyOf(position))
    else this.signs.set(keyOf(position), { position, text })
  }

  signText (position) {
    return this.signs.get(keyOf(position))?.text ?? ''
  }

  /** Return [x, y, z, text] of all signs with a text, in order. @returns {Array} */
  signStates () {
    return [...this.signs.values()].map(({ position, text }) => [...listOf(position), text]).sort(byPlace)
  }

  attribute (position, before, after) {
    const detail = { position: listOf(position) }
    const { properties } = after
    if (before.name === after.name) {
      if (after.name === 'lever' && before.properties.powered !== properties.powered) this.used(position, 'use_lever', { ...detail, powered: properties.powered })
      if (after.name.endsWith('_button') && properties.powered && !before.properties.powered) this.used(position, 'press_button', detail)
      if (after.name === 'barrel' && before.properties.open !== properties.open) this.lids.moved(position, Number(properties.open))
      if (BY_HAND.test(after.name) && before.properties.open !== properties.open) this.usedDoor(position, after)
    } else if (after.name === 'air' || after.name === 'water') {
      this.mined.push({ position: vecOf(position), at: this.region.followed })
      this.did(this.whoTried('dig', position), position, 'mine_block', { ...detail, block: this.states.text(before.stateId) })
    } else {
      this.placed(position, after)
    }
  }

  used (position, kind, detail) {
    this.did(this.whoTried('use', position), position, kind, detail)
  }

  /**
   * Record an act on a block. `who` is the witness of the bot that did it; null if a person may have, who is found
   * later.
   */
  did (who, position, kind, detail) {
    const tell = actor => this.deeds.push({ who: actor, kind, detail })
    if (who === null) this.explainLater(position, tell)
    else tell(who)
  }

  /**
   * Call `tell` with the witness of the person who is seen to have acted on a position, now or within a moment; do not
   * call it if nobody is.
   */
  explainLater (position, tell) {
    this.unexplained.push({ position: vecOf(position), at: this.region.followed, tell })
  }

  explain () {
    const now = this.region.followed
    this.unexplained = this.unexplained.filter(({ position, at, tell }) => {
      const who = this.people.whoActed(position)
      if (who !== null) tell(who)
      return who === null && now - at <= SWINGS_WITHIN
    })
  }

  /**
   * Record the use of a door. Its position is that of its lower half, whichever half was used; the half that changes
   * first causes the event.
   */
  usedDoor (position, { name, properties }) {
    const isUpper = name.endsWith('_door') && properties.half === 'upper'
    const lower = isUpper ? position.offset(0, -1, 0) : position
    const upper = lower.offset(0, 1, 0)
    const other = this.at(isUpper ? lower : upper)
    if (name.endsWith('_door') && other.name === name && other.properties.open === properties.open) return
    this.did(this.whoTried('use', lower) ?? this.whoTried('use', upper), lower, 'use_door', { position: listOf(lower), open: properties.open })
  }

  /** Attribute a new block to the agent who just used an item on that position or next to it. */
  placed (position, after) {
    if (after.properties.half === 'upper' && after.name.endsWith('_door')) return
    const faces = [[0, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1], [-1, 0, 0], [1, 0, 0]]
    const who = faces.reduce((player, face) => player ?? this.whoTried('use', position.plus(new Vec3(...face))), null)
    this.did(who, position, 'place_block', { position: listOf(position), block: this.states.text(after.stateId) })
  }

  /** Return the witness of the agent whose bot has just attempted an act; null if there is none. */
  whoTried (kind, position) {
    return [...this.witnesses.values()].find(witness => witness.hasTried(kind, position)) ?? null
  }

  /** Return true if a bot has just used the block, or is about to see its contents. */
  isUsedByBot (position) {
    const halves = this.halvesAt(position)
    return [...this.witnesses.values()].some(witness => halves.some(half => witness.usesNow(half)))
  }

  isOpenToBot (position) {
    return [...this.witnesses.values()].some(({ windows }) => windows.shows(position))
  }

  /** Attribute an item to a person if no bot threw it and it is not the drop of a mined block. */
  thrownByPerson ({ position }, { name, count }) {
    const now = this.region.followed
    const isMined = this.mined.some(({ position: place, at }) => now - at <= FALLS_WITHIN && place.offset(0.5, 0.5, 0.5).distanceTo(position) <= 1)
    const agent = isMined ? null : this.people.whoThrew(position)
    if (agent !== null) this.thrown.push({ agent, name, count, at: now })
  }

  /** Remember words that an agent has sent; they are recorded when they are heard. */
  expect (words) {
    this.expected.push({ ...words, at: this.region.followed })
  }

  /** Handle a line that a player received; agent `null` is the operator. */
  heardBy (agent, text) {
    const line = spaced(text)
    const index = this.expected.findIndex(({ actor, text: said, to }) => line.includes(actor) && line.endsWith(spaced(said)) &&
      (to === undefined ? agent === null : agent === to))
    if (index < 0) return
    const [{ actor, text: said, to }] = this.expected.splice(index, 1)
    this.region.emit({ kind: 'chat', actor, detail: to === undefined ? { text: said } : { text: said, to } })
  }

  /** Return true if all words of agents have been heard or given up, and no container is being checked. */
  get isQuiet () {
    if (!this.lids.isQuiet) return false
    this.expected = this.expected.filter(({ at }) => this.region.followed - at <= UNHEARD_AFTER)
    return this.expected.length === 0
  }

  /** Listen to the operator's connection. */
  attach (bot, client) {
    bot.on('blockUpdate', (_, block) => { if (block !== null) this.blockChanged(block.position, this.mapping.fromServer(block.stateId)) })
    bot.on('messagestr', text => this.heardBy(null, text))
    bot.on('blockEntityData', block => { if (block?.name.endsWith('_sign')) this.signShown(block.position, textOf(block)) })
    bot.on('itemDrop', entity => this.dropped(entity))
    bot.on('entityGone', entity => this.items.gone(entity.id))
    client.on('collect', packet => this.collected(bot, packet))
    client.on('block_action', ({ location, byte1, byte2 }) => { if (byte1 === LID) this.lids.moved(location, byte2) })
    this.people.attach(bot)
    this.items.entities = () => bot.entities
  }

  dropped (entity) {
    const stack = entity.getDroppedItem?.()
    const isKnown = !stack || this.thrown.some(({ name, count }) => name === stack.name && count === stack.count)
    if (!isKnown && !this.items.drops.has(entity.id)) this.thrownByPerson(entity, stack)
    this.items.appeared(entity, this.thrown)
  }

  collected (bot, { collectedEntityId, collectorEntityId, pickupItemCount }) {
    const receiver = this.witnesses.get(bot.entities[collectorEntityId]?.username)
    const item = this.items.stackOf(collectedEntityId)
    if (receiver === undefined || item === null) return
    const { by, left } = without(this.items.throwsOf(collectedEntityId), pickupItemCount)
    this.items.setThrows(collectedEntityId, left)
    handOver([...this.witnesses.values()], this.region.followed, receiver, by, item)
  }

  endTick () {
    for (const witness of this.witnesses.values()) witness.endTick()
    this.explain()
    for (const { who, kind, detail } of this.deeds.splice(0)) who.emitEvent({ kind, detail })
    this.thrown = this.thrown.filter(({ at }) => this.region.followed - at <= UNHEARD_AFTER)
    this.mined = this.mined.filter(({ at }) => this.region.followed - at <= FALLS_WITHIN)
    this.lids.endTick()
  }
}

/** Return a text as servers deliver it: each run of spaces becomes one. */
const spaced = text => text.replace(/\s+/g, ' ').trim()

/** Return the part of a server's interface that the plugins for reports use, in scenario coordinates. */
function servFor (scene) {
  return {
    get players () { return [...scene.witnesses.values()] },
    region: {
      emit: event => scene.region.emit(event),
      toServer: ([x, y, z]) => new Vec3(x, y, z),
      toScenario: ({ x, y, z }) => [x, y, z]
    }
  }
}

module.exports = { Scene }
