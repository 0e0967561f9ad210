'use strict'
/**
 * Containers that are opened by people or by players who are no agents, whose clicks we do not receive. The lid shows
 * when such a container is open. The items moved are the difference between the server's data and the known contents,
 * except what agents' own clicks have moved.
 */
const { difference } = require('../server/plugins/lib/items')
const { keyOf, listOf, vecOf } = require('../server/plugins/lib/positions')

// Number of ticks between two checks of a container that stays open.
const LOOKED_EVERY = 10
const MOVES = { deposit_item_into_chest: 1, get_item_from_chest: -1 }

class Lids {
  /**
   * @param {import('./scene').Scene} scene
   * @param {(position: number[]) => Promise<object | null>} read returns the ITEMS of a container from the server's
   *   data
   */
  constructor (scene, read) {
    this.scene = scene
    this.read = read
    // By position: {position, who, items: known contents, lookAt: tick of the next check, isShut, isBusy}.
    this.open = new Map()
  }

  /** Handle a moved lid; `viewers` is the number of players who look into the container. */
  moved (place, viewers) {
    const { scene } = this
    const position = scene.wholeAt(vecOf(place))
    if (!scene.contents.has(position)) return
    const lid = this.open.get(keyOf(position))
    const { tick } = scene.region
    if (lid !== undefined) {
      Object.assign(lid, { isShut: viewers === 0, lookAt: tick })
      return
    }
    if (viewers > 0 && !scene.isUsedByBot(position)) this.follow(position)
    // Somebody may have looked in together with a bot.
    else if (viewers === 0 && scene.people.here.size > 0) this.begin(position, { who: scene.people.whoActed(position), isShut: true, lookAt: tick })
  }

  /** Begin a session of a player who is no bot; the scene finds out later who it is. */
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

  /** Apply the moves of an agent's own clicks, so that they are not attributed to the other player. */
  account ({ kind, detail: { position, items } }) {
    const session = MOVES[kind] === undefined ? undefined : this.open.get(position.join())
    if (session === undefined) return
    for (const [name, count] of Object.entries(items)) add(session.items, name, MOVES[kind] * count)
  }

  /** Check the containers that are due; called at the end of a tick. */
  endTick () {
    const { tick } = this.scene.region
    for (const session of this.open.values()) {
      if (session.isBusy || tick < session.lookAt || this.scene.isOpenToBot(session.position)) continue
      session.isBusy = true
      this.look(session).catch(error => this.scene.fail(error)).finally(() => { session.isBusy = false })
    }
  }

  /** Return true if all moves have been reported. */
  get isQuiet () {
    return [...this.open.values()].every(({ isShut, isBusy }) => !isShut && !isBusy)
  }

  async look (session) {
    const { scene, open } = this
    const { position, isShut } = session
    session.lookAt = scene.region.tick + LOOKED_EVERY
    const items = await this.read(listOf(position))
    const isThere = scene.contents.has(position)
    if (items !== null && isThere) this.tell(session, items)
    if ((isShut && session.isShut) || !isThere) open.delete(keyOf(position))
  }

  tell (session, present) {
    const { position, who, items } = session
    const moved = difference(items, present)
    session.items = { ...present }
    this.scene.contents.know(position, present)
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
