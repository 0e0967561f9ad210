'use strict'
/** What is known to be in the containers of a place: what was put in at the start, and what open windows show. */
const { countByName } = require('../server/plugins/lib/items')
const { byPlace, keyOf, listOf, vecOf } = require('../server/plugins/lib/positions')
const { sorted } = require('../regions/facts')

class Contents {
  constructor () {
    this.held = new Map()
    this.changed = new Map()
  }

  /** A container holds exactly this. */
  know (position, items) {
    const key = keyOf(position)
    const before = this.held.get(key)
    if (before !== undefined && JSON.stringify(sorted(before.items)) === JSON.stringify(sorted(items))) return
    this.held.set(key, { position: vecOf(position), items })
    this.changed.set(key, vecOf(position))
  }

  /** A container holds these stacks, as a window shows. */
  show (position, stacks) {
    this.know(position, countByName(stacks))
  }

  has (position) {
    return this.held.has(keyOf(position))
  }

  /** @returns {object} ITEMS of a container that there is */
  get (position) {
    return this.held.get(keyOf(position)).items
  }

  /** No container is left at a position. */
  forget (position) {
    if (this.held.delete(keyOf(position))) this.changed.set(keyOf(position), vecOf(position))
  }

  /** @returns {Array} [x, y, z, ITEMS] of all, in order */
  states () {
    return [...this.held.values()].map(({ position, items }) => [...listOf(position), sorted(items)]).sort(byPlace)
  }

  /** @returns {Array} [x, y, z, ITEMS or null] of those that changed since the last call */
  drain () {
    const rows = [...this.changed.entries()].map(([key, position]) => {
      const held = this.held.get(key)
      return [...listOf(position), held === undefined ? null : sorted(held.items)]
    })
    this.changed.clear()
    return rows
  }
}

module.exports = { Contents }
