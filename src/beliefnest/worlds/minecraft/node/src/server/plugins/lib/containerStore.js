'use strict'

const { isDeepStrictEqual } = require('node:util')
const { countByName, equal, rowsOf, slotsOf, stacksOf } = require('./items')
const { halvesAt } = require('./doubleChest')
const { byPlace, keyOf, listOf, vecOf } = require('./positions')

/**
 * Contents of containers by block position. A container is a block whose kind was declared with `define`, or both halves
 * of a double chest: each half keeps its own slots, but contents are reported and set for the whole, at the position of
 * its first half.
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
  define (name, size, arrange = (stacks) => stacks) {
    this.kinds.set(name, { name, size, arrange })
  }

  /** Return true if a block state is a container. */
  holds (stateId) {
    return this.kinds.has(this.serv.blocks.describe(stateId).name)
  }

  kindAt (position) {
    return this.kinds.get(this.serv.blocks.at(position).name)
  }

  /** Return the positions of the halves of the container at a position, or its one position. */
  halves (position) {
    return halvesAt(this.serv.blocks.at, position)
  }

  /** Return the position of the container to which the block at a position belongs. */
  wholeAt (position) {
    return this.halves(position)[0]
  }

  /** Return the slots of the whole container at a position. */
  allSlots (position) {
    return this.halves(position).flatMap((half) => this.slots(half))
  }

  /** Return the slots of the block at a position. The caller must call `touch` after changing them. */
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
    this.mark(this.wholeAt(position))
    this.viewers(position).forEach((player) => player.windows.sync())
  }

  mark (position) {
    this.changed.set(keyOf(position), vecOf(position))
  }

  /** Return the players who look into the container at a position. */
  viewers (position) {
    return this.serv.players.filter((player) => player.windows.looksInto(position))
  }

  /**
   * Return counts by item name; null if there is no container, or the second half of one.
   * @returns {Object<string, number> | null}
   */
  get (position) {
    if (this.kindAt(position) === undefined) return null
    const halves = this.halves(position)
    if (!halves[0].equals(vecOf(position))) return null
    return countByName(halves.flatMap((half) => this.stored.get(keyOf(half))?.slots ?? []))
  }

  /** Set the contents of the whole container at a position. @throws RangeError if there is none, or they do not fit */
  set (position, counts) {
    const kind = this.kindAt(position)
    if (kind === undefined) {
      throw new RangeError(`there is no container, but ${this.serv.blocks.at(position).name}`)
    }
    const arranged = this.arranged(position, counts)
    if (arranged === null) {
      const size = this.allSlots(position).length
      throw new RangeError(`the items given do not fit into the ${size} slots of the ${kind.name}`)
    }
    this.fill(position, arranged)
    this.touch(position)
  }

  /** Return the slots of a whole container for given contents; null if they do not fit. */
  arranged (position, counts) {
    const size = this.allSlots(position).length
    const slots = this.kindAt(position).arrange(stacksOf(this.serv.Item, this.serv.registry, counts))
    return slots && slots.length <= size ? Array.from({ length: size }, (_, i) => slots[i] ?? null) : null
  }

  /** Fill the slots of a whole container. */
  fill (position, stacks) {
    let filled = 0
    for (const half of this.halves(position)) {
      const slots = this.slots(half)
      slots.forEach((_, i) => { slots[i] = stacks[filled + i] })
      filled += slots.length
    }
  }

  /**
   * Return rows `[x, y, z, ...[slot, name, count]]` of the containers whose slots differ from those that `set` would
   * fill.
   * @returns {Array}
   */
  save (region) {
    return this.positions((place) => region.contains(place)).flatMap((position) => {
      const slots = this.allSlots(position)
      const usual = this.arranged(position, countByName(slots))
      return usual && usual.every((item, i) => equal(item, slots[i])) ? [] : [[...region.toScenario(position), ...rowsOf(slots)]]
    })
  }

  /** Fill containers as `save` returned them. */
  restore (rows, region) {
    const slotsByPlace = new Map(rows.map(([x, y, z, ...slots]) => [keyOf(region.toServer([x, y, z])), slots]))
    for (const position of this.positions((place) => region.contains(place))) {
      const present = this.allSlots(position)
      const counts = countByName(present)
      const slots = slotsOf(this.serv.Item, this.serv.registry, slotsByPlace.get(keyOf(position)) ?? [], present.length)
      const same = isDeepStrictEqual(countByName(slots), counts)
      this.fill(position, same ? slots : this.arranged(position, counts) ?? present)
    }
  }

  /**
   * Handle a changed block. Return the items that were inside the old one.
   * @param {object} old description of the block before
   * @param {object} now description of the block after
   */
  blockChanged (position, old, now) {
    const [before, after] = [old.name, now.name]
    if (!(this.kinds.has(before) || this.kinds.has(after))) return []
    const wholes = this.changedWholes(position, old, now)
    if (before !== after || wholes.length > 1) wholes.forEach((place) => this.mark(place))
    if (before === after) return []
    const items = this.stored.get(keyOf(position))?.slots.filter(Boolean) ?? []
    this.drop(position)
    return items
  }

  /**
   * Return the positions of the containers that a changed block was or is, and of blocks that it joined or left as a
   * half of a double chest.
   */
  changedWholes (position, old, now) {
    const blockAs = (block) => (place) => (place.equals(position) ? block : this.serv.blocks.at(place))
    const containers = [old, now].filter(({ name }) => this.kinds.has(name)).map((block) => halvesAt(blockAs(block), position))
    const others = containers.flat().filter((half) => !half.equals(position))
    const isOne = containers.some(([first]) => first.equals(position))
    return [...(isOne ? [position] : []), ...others]
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
      .filter((position) => this.wholeAt(position).equals(position))
    return places.sort((a, b) => byPlace(listOf(a), listOf(b)))
  }

  /** Forget everything about a part of the world. */
  forget (within) {
    for (const { position } of [...this.stored.values()]) {
      if (within(position)) this.drop(position)
    }
    this.drainChanges(within)
  }
}

module.exports = { ContainerStore }
