'use strict'
/** Block states as names and properties, after minecraft-data's `states` lists. */

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

/** Properties of a block state: name to boolean, number or text. */
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

/** State id of a block with these properties; those not named keep the default state's value. */
function encode (registry, name, properties) {
  const block = registry.blocksByName[name]
  const all = { ...decode(registry, block.defaultState), ...properties }
  let index = 0
  for (const state of block.states) {
    index = index * state.num_values + indexOf(state, all[state.name])
  }
  return block.minStateId + index
}

module.exports = { decode, encode }
