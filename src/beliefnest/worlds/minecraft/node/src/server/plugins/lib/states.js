'use strict'
/** Block states as names and properties, from minecraft-data's `states` lists. */

const FULL_CUBE = '[[0,0,0,1,1,1]]'

function valueAt (state, index) {
  if (state.type === 'bool') return index === 0
  if (state.type === 'int') return state.values ? Number(state.values[index]) : index
  return state.values[index]
}

function indexOf (state, value) {
  if (state.type === 'bool') return value === true || value === 'true' ? 0 : 1
  const index = state.values ? state.values.indexOf(String(value)) : Number(value)
  if (!(index >= 0 && index < state.num_values)) {
    throw new RangeError(`block property ${state.name} cannot be ${value}`)
  }
  return index
}

/** Return the properties of a block state: name to boolean, number or text. */
function decode (registry, stateId) {
  const block = registry.blocksByStateId[stateId]
  const properties = {}
  let rest = stateId - block.minStateId
  for (const state of [...block.states].reverse()) {
    properties[state.name] = valueAt(state, rest % state.num_values)
    rest = Math.floor(rest / state.num_values)
  }
  return properties
}

/** Return the state id of a block with these properties; others keep the default state's value. */
function encode (registry, name, properties) {
  const block = registry.blocksByName[name]
  const all = { ...decode(registry, block.defaultState), ...properties }
  let index = 0
  for (const state of block.states) {
    index = index * state.num_values + indexOf(state, all[state.name])
  }
  return block.minStateId + index
}

/** Return cached queries about the block states of a version. */
function blockStates (registry) {
  const Block = require('prismarine-block')(registry)
  const lookups = new Map()

  /** Return `{stateId, type, name, shapes, solid, full, transparent, properties}`. */
  function describe (stateId) {
    if (!lookups.has(stateId)) {
      const block = Block.fromStateId(stateId, 0)
      lookups.set(stateId, Object.freeze({
        stateId,
        type: block.type,
        name: block.name,
        shapes: block.shapes,
        solid: block.boundingBox === 'block',
        full: JSON.stringify(block.shapes) === FULL_CUBE,
        transparent: block.transparent,
        properties: Object.freeze(decode(registry, stateId)),
      }))
    }
    return lookups.get(stateId)
  }

  /** Return a state as text, e.g. `lever[face=floor,facing=north,powered=true]`. */
  function text (stateId) {
    const { name, properties } = describe(stateId)
    const entries = Object.entries(properties).sort(([a], [b]) => (a < b ? -1 : 1))
    return entries.length ? `${name}[${entries.map((entry) => entry.join('=')).join(',')}]` : name
  }

  return { describe, text }
}

module.exports = { blockStates, decode, encode }
