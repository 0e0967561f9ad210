'use strict'
/** Dropped items of a place on a remote server: their numbers on the timeline, and who threw them. */
const { rounded } = require('../regions/facts')

// Each tick has its own numbers, as in the embedded world.
const NUMBERS_PER_TICK = 100

class Items {
  constructor (region) {
    this.region = region
    this.entities = () => ({})
    // By entity id on the server: {number, throws}.
    this.drops = new Map()
    this.awaited = []
    this.last = 0
  }

  /** Announce items that commands are about to summon, with their numbers. */
  await (items) {
    this.drops.clear()
    this.awaited = Object.entries(items).map(([number, item]) => ({ number: Number(number), ...item }))
    this.last = Math.max(0, ...Object.keys(items).map(Number))
  }

  appeared (entity, thrown) {
    const stack = entity.getDroppedItem?.()
    if (!stack || this.drops.has(entity.id)) return
    const index = this.awaited.findIndex(({ name, count }) => name === stack.name && count === stack.count)
    const number = index < 0 ? this.nextNumber() : this.awaited.splice(index, 1)[0].number
    const by = thrown.findIndex(({ name, count }) => name === stack.name && count === stack.count)
    const throws = by < 0 ? [] : thrown.splice(by, 1).map(({ agent, count, at }) => [agent, count, at])
    this.drops.set(entity.id, { number, throws })
  }

  nextNumber () {
    this.last = Math.max(this.last + 1, (this.region.tick + 1) * NUMBERS_PER_TICK)
    return this.last
  }

  gone (id) {
    this.drops.delete(id)
  }

  stackOf (id) {
    return this.entities()[id]?.getDroppedItem?.() ?? null
  }

  throwsOf (id) {
    return this.drops.get(id)?.throws ?? []
  }

  setThrows (id, throws) {
    if (this.drops.has(id)) this.drops.get(id).throws = throws
  }

  /** Return ITEM by number, for the items in the box. @returns {object} */
  states () {
    const stacks = {}
    for (const [id, { number }] of this.drops) {
      const entity = this.entities()[id]
      const stack = this.stackOf(id)
      if (!stack || !this.isInside(entity.position)) continue
      const { x, y, z } = entity.position
      stacks[number] = { name: stack.name, count: stack.count, position: [x, y, z].map(rounded) }
    }
    return stacks
  }

  isInside ({ x, y, z }) {
    return this.region.box.contains(Math.floor(x), Math.floor(y), Math.floor(z))
  }
}

module.exports = { Items }
