'use strict'
/** Known contents of the containers of a place, from the set-up and from open windows. */
const { countByName } = require('../server/plugins/lib/items')
const { byPlace, keyOf, listOf, vecOf } = require('../server/plugins/lib/positions')
const { sorted } = require('../regions/facts')

class Contents {
  constructor () {
    this.byPlace = new Map()
    this.changed = new Map()
  }

  /** Set the contents of a container. */
  know (position, items) {
    const key = keyOf(position)
    const before = this.byPlace.get(key)
    if (before !== undefined && JSON.stringify(sorted(before.items)) === JSON.stringify(sorted(items))) return
    this.byPlace.set(key, { position: vecOf(position), items })
    this.changed.set(key, vecOf(position))
  }

  /** Set the contents of a container to the stacks of a window. */
  show (position, stacks) {
    this.know(position, countByName(stacks))
  }

  has (position) {
    return this.byPlace.has(keyOf(position))
  }

  /** Return the ITEMS of a known container. @returns {object} */
  get (position) {
    return this.byPlace.get(keyOf(position)).items
  }

  /** Forget the container at a position; it no longer exists. */
  forget (position) {
    if (this.byPlace.delete(keyOf(position))) this.changed.set(keyOf(position), vecOf(position))
  }

  /** Return [x, y, z, ITEMS] of all containers, in order. @returns {Array} */
  states () {
    return [...this.byPlace.values()].map(({ position, items }) => [...listOf(position), sorted(items)]).sort(byPlace)
  }

  /** Return [x, y, z, ITEMS or null] of the containers that changed since the last call. @returns {Array} */
  drain () {
    const rows = [...this.changed.entries()].map(([key, position]) => {
      const content = this.byPlace.get(key)
      return [...listOf(position), content === undefined ? null : sorted(content.items)]
    })
    this.changed.clear()
    return rows
  }
}

module.exports = { Contents }
