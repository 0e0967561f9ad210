'use strict'
/**
 * Values that a program makes or gets as copies: goals, movements, blocks, items.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineValues (env) {
  const notes = env.own(new WeakMap())
  const texts = env.own(new WeakMap())

  function described (tag, name) {
    return class {
      constructor (...args) {
        notes.set(this, { $: tag, n: name, a: args })
      }
    }
  }

  const goals = {}
  for (const name of env.config.goals) {
    goals[name] = described('g', name)
    Object.defineProperty(goals[name], 'name', { value: name })
  }

  class Movements {}

  class Block {
    getProperties () { return { ...this._properties } }

    getSignText () { return [texts.get(this) ?? '', ''] }

    canHarvest (heldItemType) {
      if (!this.harvestTools) return true
      return heldItemType != null && Object.hasOwn(this.harvestTools, heldItemType)
    }
  }

  class Item {}

  function makeBlock (state, x, y, z, light, skyLight, text) {
    const block = Object.assign(new Block(), state, { position: env.vector(x, y, z), light, skyLight })
    notes.set(block, { $: 'b', c: [x, y, z] })
    if (text !== undefined) texts.set(block, text)
    return Object.freeze(block)
  }

  function makeItem (data) {
    const item = Object.assign(new Item(), data)
    notes.set(item, { $: 'i', slot: data.slot, type: data.type })
    return Object.freeze(item)
  }

  Object.assign(env, { goals, Movements, makeBlock, makeItem, noteOf: (value) => notes.get(value) })
}
