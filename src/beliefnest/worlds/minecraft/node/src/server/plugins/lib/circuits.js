'use strict'
/**
 * Facts about redstone power by block state. The scripted world gets the same facts from the build
 * (circuits.js beside build.js). A block here is what `blockStates().describe` returns.
 */
const { encode } = require('./states')
const { FACES, FACE_NAMES } = require('./directions')
const { holderOf } = require('./holders')

const SWITCH = /^lever$|_button$/
const PLATE = /(?<!_weighted)_pressure_plate$/
const STONE_PLATE = /^(stone|polished_blackstone)_pressure_plate$/
const OPENS = /_door$|_trapdoor$|_fence_gate$/
const LAMP = 'redstone_lamp'
const WIRE = 'redstone_wire'
// Minecraft exempts these from its rule that opaque full cubes carry power.
const NEVER_CONDUCTS = /^(tnt|observer|redstone_block|glowstone|sea_lantern|.*copper_bulb)$/
const ALWAYS_CONDUCTS = /^(soul_sand|mud)$/

/** Ticks and lengths of the rules. */
const FACTS = {
  /** Power of a source, which is also the number of wires that it reaches. */
  range: 15,
  /** Ticks after which a lamp without power goes dark. */
  dims: 4,
  /** Ticks between two looks of a pressed plate at who stands on it. */
  plateLooks: 20,
  /** Distance between the edge of a plate's block and the part that is touched. */
  plateInset: 0.0625,
  /** Height of the part of a plate that is touched. */
  plateHeight: 0.25,
}

/** Return true if a block carries power from a source that is attached to it. @returns {boolean} */
function conducts (block) {
  if (ALWAYS_CONDUCTS.test(block.name)) return true
  return !block.transparent && !NEVER_CONDUCTS.test(block.name) && block.full
}

/**
 * Return the face number of the block that a source powers strongly; -1: no block; null: it is no source, or off.
 * @returns {number | null}
 */
function sourceOf (block) {
  if (block.name === 'redstone_block') return -1
  if (!block.properties.powered) return null
  if (PLATE.test(block.name)) return FACE_NAMES.indexOf('down')
  if (!SWITCH.test(block.name)) return null
  const holder = holderOf(block)
  return FACES.findIndex((face) => face.equals(holder))
}

/** Return true if wires connect to a block beside them. @returns {boolean} */
const connects = ({ name }) => name === WIRE || name === 'redstone_block' || SWITCH.test(name) || PLATE.test(name)

/**
 * Return the state id of a block after it gets or loses power; null if its state stays as it is.
 * @returns {number | null}
 */
function answerOf (registry, { name, properties }, powered) {
  if (name === LAMP) return properties.lit === powered ? null : encode(registry, name, { lit: powered })
  if (!OPENS.test(name) || properties.powered === powered) return null
  return encode(registry, name, { ...properties, powered, open: powered })
}

/** Return the step in y from one half of a door to the other; 0 for other blocks. @returns {number} */
function otherHalfOf ({ name, properties }) {
  if (!name.endsWith('_door')) return 0
  return properties.half === 'lower' ? 1 : -1
}

/** Return what presses a plate: `all` entities or `living` ones; null for other blocks. @returns {string | null} */
function pressedBy ({ name }) {
  if (!PLATE.test(name)) return null
  return STONE_PLATE.test(name) ? 'living' : 'all'
}

module.exports = { FACTS, LAMP, WIRE, answerOf, conducts, connects, otherHalfOf, pressedBy, sourceOf }
