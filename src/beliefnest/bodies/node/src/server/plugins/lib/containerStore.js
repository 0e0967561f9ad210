'use strict'

const { isDeepStrictEqual } = require('node:util')
const { countByName, equal, rowsOf, slotsOf, stacksOf } = require('./items')
const { byPlace, keyOf, listOf, vecOf } = require('./positions')

/**
 * What containers hold, by block position; each half of a double chest holds its own 27 slots.
 * A container is whatever block has a kind declared with `define`.
 */
class ContainerStore {
  /** @param {object} serv */
  constructor (serv) {
    this.serv = serv
    this.kinds = new Map()
    this.stored = new Map()
    this.changed = new Map()
  }

  /**
   * Declare a kind of block that holds items.
   * @param {string} name of the block
   * @param {number} size in slots
   * @param {(stacks: object[]) => object[] | null} arrange gives the slots a content is set into,
   *   null where it does not fit; by default one after the other
   */
  define (name, size, arrange = (stacks) => (stacks.length > size ? null : stacks)) {
    this.kinds.set(name, { name, size, arrange })
  }

  kindAt (position) {
    return this.kinds.get(this.serv.blocks.at(position).name)
  }

  /** The slots of the container at a position; only for those who call `touch` afterwards. */
  slots (position) {
    const key = keyOf(position)
    if (!this.stored.has(key)) {
      const { size } = this.kindAt(position)
      this.stored.set(key, { position: vecOf(position), slots: new Array(size).fill(null) })
    }
    return this.stored.get(key).slots
  }

  /** Take note of a container that was built with its region, if there is one. */
  stand (position) {
    if (this.kindAt(position) !== undefined) this.slots(position)
  }

  /** To be called after slots were changed: notes it and shows it to those who look in. */
  touch (position) {
    this.changed.set(keyOf(position), vecOf(position))
    this.viewers(position).forEach((player) => player.windows.sync())
  }

  /** Players who look into the container at a position. */
  viewers (position) {
    return this.serv.players.filter((player) => player.windows.looksInto(position))
  }

  /** @returns {Object<string, number> | null} item name to count; null where no container stands */
  get (position) {
    if (this.kindAt(position) === undefined) return null
    return countByName(this.stored.get(keyOf(position))?.slots ?? [])
  }

  /** Make a container hold exactly this. @throws RangeError where it cannot */
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

  /** The slots that a content is set into, or null where it does not fit. */
  arranged (kind, counts) {
    const slots = kind.arrange(stacksOf(this.serv.Item, this.serv.registry, counts))
    return slots && Array.from({ length: kind.size }, (_, i) => slots[i] ?? null)
  }

  fill (position, stacks) {
    const slots = this.slots(position)
    slots.forEach((_, i) => { slots[i] = stacks[i] })
  }

  /** @returns {Array} rows `[x, y, z, ...[slot, name, count]]` of containers whose slots are not as `set` fills them */
  save (region) {
    return this.positions((place) => region.contains(place)).flatMap((position) => {
      const slots = this.slots(position)
      const usual = this.arranged(this.kindAt(position), countByName(slots))
      return usual && usual.every((item, i) => equal(item, slots[i])) ? [] : [[...region.toScenario(position), ...rowsOf(slots)]]
    })
  }

  /** Put what containers hold into the slots that `save` told. */
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

  /** Take note that another block came; returns the items that were inside the old one. */
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

  /** Positions of a part of the world whose content changed, or whose container came or went, since the last call. */
  drainChanges (within) {
    const result = [...this.changed.values()].filter(within)
    result.forEach((position) => this.changed.delete(keyOf(position)))
    return result
  }

  /** Positions of the containers of a part of the world that anyone opened or put there, in order. */
  positions (within) {
    const places = [...this.stored.values()].map(({ position }) => position).filter(within)
    return places.sort((a, b) => byPlace(listOf(a), listOf(b)))
  }

  /** Drop all that is known of a part of the world. */
  forget (within) {
    this.positions(within).forEach((position) => this.drop(position))
    this.drainChanges(within)
  }
}

module.exports = { ContainerStore }
