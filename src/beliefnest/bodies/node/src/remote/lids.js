'use strict'
/**
 * Containers that somebody opens whose clicks nobody hears: a person, or a player who is no agent. Their lids tell when;
 * what was moved is what the server says they hold then, less what agents' own clicks account for.
 */
const { difference } = require('../server/plugins/lib/items')
const { keyOf, listOf, vecOf } = require('../server/plugins/lib/positions')

// Ticks between two looks into a container that stays open.
const LOOKED_EVERY = 10
const MOVES = { deposit_item_into_chest: 1, get_item_from_chest: -1 }

class Lids {
  /**
   * @param {import('./scene').Scene} scene
   * @param {(position: number[]) => Promise<object | null>} read ITEMS of a container, as the server has it
   */
  constructor (scene, read) {
    this.scene = scene
    this.read = read
    // By place: {position, who, items: what is accounted for, lookAt: the next tick, isShut, isBusy}.
    this.open = new Map()
  }

  /** A lid moved: so many look in. */
  moved (place, viewers) {
    const { scene } = this
    const position = vecOf(place)
    if (!scene.contents.has(position)) return
    const known = this.open.get(keyOf(position))
    const { tick } = scene.region
    if (known !== undefined) {
      Object.assign(known, { isShut: viewers === 0, lookAt: tick })
      return
    }
    if (viewers > 0 && !scene.isUsedByBot(position)) this.follow(position)
    // Somebody may have looked in together with a bot.
    else if (viewers === 0 && scene.people.here.size > 0) this.begin(position, { who: scene.people.whoActed(position), isShut: true, lookAt: tick })
  }

  /** Somebody who is no bot looks in; who it is shows by and by. */
  follow (position) {
    const session = this.begin(position, { who: null, isShut: false, lookAt: this.scene.region.tick + LOOKED_EVERY })
    this.scene.explainLater(position, who => {
      session.who = who
      who.emitEvent({ kind: 'open_container', detail: { position: listOf(position) } })
    })
  }

  begin (position, more) {
    const session = { position, items: { ...this.scene.contents.get(position) }, isBusy: false, ...more }
    this.open.set(keyOf(position), session)
    return session
  }

  /** What an agent's own clicks moved. */
  account ({ kind, detail: { position, items } }) {
    const session = MOVES[kind] === undefined ? undefined : this.open.get(position.join())
    if (session === undefined) return
    for (const [name, count] of Object.entries(items)) add(session.items, name, MOVES[kind] * count)
  }

  /** At the end of a tick: looks into what is due. */
  endTick () {
    const { tick } = this.scene.region
    for (const session of this.open.values()) {
      if (session.isBusy || tick < session.lookAt || this.scene.isOpenToBot(session.position)) continue
      session.isBusy = true
      this.look(session).catch(error => this.scene.fail(error)).finally(() => { session.isBusy = false })
    }
  }

  /** Whether nothing that was moved is still to be told. */
  get isQuiet () {
    return [...this.open.values()].every(({ isShut, isBusy }) => !isShut && !isBusy)
  }

  async look (session) {
    const { scene, open } = this
    const { position, isShut } = session
    session.lookAt = scene.region.tick + LOOKED_EVERY
    const found = await this.read(listOf(position))
    const isThere = scene.contents.has(position)
    if (found !== null && isThere) this.tell(session, found)
    if ((isShut && session.isShut) || !isThere) open.delete(keyOf(position))
  }

  tell (session, found) {
    const { position, who, items } = session
    const moved = difference(items, found)
    session.items = { ...found }
    this.scene.contents.know(position, found)
    if (who === null) return
    for (const [kind, sign] of [['get_item_from_chest', -1], ['deposit_item_into_chest', 1]]) {
      const part = Object.entries(moved).filter(([, count]) => count * sign > 0).map(([name, count]) => [name, count * sign])
      if (part.length > 0) who.emitEvent({ kind, detail: { position: listOf(position), items: Object.fromEntries(part) } })
    }
  }
}

function add (items, name, count) {
  items[name] = (items[name] ?? 0) + count
  if (items[name] === 0) delete items[name]
}

module.exports = { Lids }
