'use strict'

const { isDeepStrictEqual } = require('node:util')
const { countByName, equal, rowsOf, slotsOf, stacksOf } = require('./items')
const { byPlace, keyOf, listOf, vecOf } = require('./positions')

/**
 * Contents of containers by block position; each half of a double chest holds its own 27 slots. A container is a block
 * whose kind was declared with `define`.
 */
class ContainerStore {
  /**
   * @param {object} serv
   */
  constructor (serv) {
    this.serv = serv
    this.kinds = new Map()
    this.stored = new Map()
    this.changed = new Map()
  }

  /**
   * Declare a kind of block that holds items.
   * @param {string} name name of the block
   * @param {number} size number of slots
   * @param {(stacks: object[]) => object[] | null} arrange returns the slots for given stacks, or null if they do not
   *   fit; one after the other by default
   */
  define (name, size, arrange = (stacks) => (stacks.length > size ? null : stacks)) {
    this.kinds.set(name, { name, size, arrange })
  }

  /** Return true if a block state is a container. */
  holds (stateId) {
    return this.kinds.has(this.serv.blocks.describe(stateId).name)
  }

  kindAt (position) {
    return this.kinds.get(this.serv.blocks.at(position).name)
  }

  /** Return the slots of the container at a position. The caller must call `touch` after changing them. */
  slots (position) {
    const key = keyOf(position)
    if (!this.stored.has(key)) {
      const { size } = this.kindAt(position)
      this.stored.set(key, { position: vecOf(position), slots: new Array(size).fill(null) })
    }
    return this.stored.get(key).slots
  }

  /** Register a container that was built with its region, if there is one. */
  stand (position) {
    if (this.kindAt(position) !== undefined) this.slots(position)
  }

  /** Record a change of slots, and send it to those who look in. */
  touch (position) {
    this.changed.set(keyOf(position), vecOf(position))
    this.viewers(position).forEach((player) => player.windows.sync())
  }

  /** Return the players who look into the container at a position. */
  viewers (position) {
    return this.serv.players.filter((player) => player.windows.looksInto(position))
  }

  /** Return counts by item name; null if there is no container. @returns {Object<string, number> | null} */
  get (position) {
    if (this.kindAt(position) === undefined) return null
    return countByName(this.stored.get(keyOf(position))?.slots ?? [])
  }

  /** Set the contents of a container. @throws RangeError if there is none, or the items do not fit */
  set (position, counts) {
    const kind = this.kindAt(position)
    if (kind === undefined) {
      throw new RangeError(`there is no container, but ${this.serv.blocks.at(position).name}`)
    }
    const arranged = this.arranged(kind, counts)
    if (arranged === null) {
      throw new RangeError(`the items given do not fit into the ${kind.size} slots of the ${kind.name}`)
    }
    this.fill(position, arranged)
    this.touch(position)
  }

  /** Return the slots for given contents; null if they do not fit. */
  arranged (kind, counts) {
    const slots = kind.arrange(stacksOf(this.serv.Item, this.serv.registry, counts))
    return slots && Array.from({ length: kind.size }, (_, i) => slots[i] ?? null)
  }

  fill (position, stacks) {
    const slots = this.slots(position)
    slots.forEach((_, i) => { slots[i] = stacks[i] })
  }

  /**
   * Return rows `[x, y, z, ...[slot, name, count]]` of the containers whose slots differ from those that `set` would
   * fill.
   * @returns {Array}
   */
  save (region) {
    return this.positions((place) => region.contains(place)).flatMap((position) => {
      const slots = this.slots(position)
      const usual = this.arranged(this.kindAt(position), countByName(slots))
      return usual && usual.every((item, i) => equal(item, slots[i])) ? [] : [[...region.toScenario(position), ...rowsOf(slots)]]
    })
  }

  /** Fill containers as `save` returned them. */
  restore (rows, region) {
    const told = new Map(rows.map(([x, y, z, ...slots]) => [keyOf(region.toServer([x, y, z])), slots]))
    for (const position of this.positions((place) => region.contains(place))) {
      const counts = countByName(this.slots(position))
      const kind = this.kindAt(position)
      const slots = slotsOf(this.serv.Item, this.serv.registry, told.get(keyOf(position)) ?? [], kind.size)
      const same = isDeepStrictEqual(countByName(slots), counts)
      this.fill(position, same ? slots : this.arranged(kind, counts) ?? this.slots(position))
    }
  }

  /** Handle a changed block. Return the items that were inside the old one. */
  blockChanged (position, before, after) {
    if (before === after || !(this.kinds.has(before) || this.kinds.has(after))) return []
    const items = this.stored.get(keyOf(position))?.slots.filter(Boolean) ?? []
    this.drop(position)
    this.changed.set(keyOf(position), position)
    return items
  }

  drop (position) {
    this.viewers(position).forEach((player) => player.windows.forceClose())
    this.stored.delete(keyOf(position))
  }

  /**
   * Return the positions in a part of the world whose contents changed, or whose container came or went, since the
   * last call.
   */
  drainChanges (within) {
    const result = [...this.changed.values()].filter(within)
    result.forEach((position) => this.changed.delete(keyOf(position)))
    return result
  }

  /**
   * Return the positions of the containers in a part of the world that were built with it, placed or opened, in order.
   */
  positions (within) {
    const places = [...this.stored.values()].map(({ position }) => position).filter(within)
    return places.sort((a, b) => byPlace(listOf(a), listOf(b)))
  }

  /** Forget everything about a part of the world. */
  forget (within) {
    this.positions(within).forEach((position) => this.drop(position))
    this.drainChanges(within)
  }
}

module.exports = { ContainerStore }
