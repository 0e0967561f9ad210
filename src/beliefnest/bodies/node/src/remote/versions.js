'use strict'
/**
 * Minecraft versions of servers elsewhere. This build's own version is the one that everybody speaks of; a server's
 * blocks are those of the same names and properties in its version.
 */
const minecraftData = require('minecraft-data')
const { pc: data } = require('minecraft-data/data')
const { BadRequest } = require('../channel/errors')
const { rememberBlocks } = require('../blocks')
const { blockStates, encode } = require('../server/plugins/lib/states')

// Names of the same block in older and newer versions, other than in ours.
const OTHER_NAMES = { short_grass: ['grass'], chain: ['iron_chain'], dirt_path: ['grass_path'] }
const AIR = 'air'
const STONE = 'stone'

/** Versions that this build has what is needed for. */
const held = () => Object.keys(data).filter(version => /^\d+\.\d+(\.\d+)?$/.test(version))

/**
 * @param {number | string} spoken a number of the protocol, or a version
 * @returns {string | null} the version held that speaks it; null if none is
 */
function heldFor (spoken) {
  if (held().includes(spoken)) return spoken
  const known = minecraftData.versions.pc
  const protocol = typeof spoken === 'number' ? spoken : known.find(({ minecraftVersion }) => minecraftVersion === spoken)?.version
  if (protocol === undefined) return null
  const same = known.filter(({ version, usesNetty }) => version === protocol && usesNetty).map(({ minecraftVersion }) => minecraftVersion)
  return same.find(version => held().includes(version)) ?? null
}

/** @returns {object} what is known of a version that is held */
function registryOf (version) {
  const registry = require('prismarine-registry')(version)
  rememberBlocks(registry)
  return registry
}

/** Block states of our version and of a server's, one for the other. */
class BlockMapping {
  /**
   * @param {object} registry of our version
   * @param {object} theirs of the server's
   */
  constructor (registry, theirs) {
    this.isSame = registry.version.minecraftVersion === theirs.version.minecraftVersion
    this.registry = registry
    this.theirs = theirs
    this.states = blockStates(registry)
    this.theirStates = blockStates(theirs)
    this.known = new Map()
    // Names of blocks of the server that ours has not; they are taken for stone, or for air where one can walk through.
    this.strange = new Set()
  }

  /** @returns {number} our state of a state of the server's */
  fromServer (state) {
    if (this.isSame) return state
    if (!this.known.has(state)) this.known.set(state, this.mapped(state))
    return this.known.get(state)
  }

  /** @returns {string} a state of ours as the server's commands name it. @throws {BadRequest} if the server has no such block */
  textForServer (state) {
    if (this.isSame) return shortText(this.registry, this.states, state)
    const { name, properties } = this.states.describe(state)
    const found = sameBlock(this.theirs, name, properties, OTHER_NAMES[name] ?? [])
    if (found === null) throw new BadRequest(`the server's Minecraft ${this.theirs.version.minecraftVersion} has no block ${name}; let the scenario have another one`)
    return shortText(this.theirs, this.theirStates, found)
  }

  mapped (state) {
    const { name, properties, solid } = this.theirStates.describe(state)
    const older = Object.keys(OTHER_NAMES).filter(own => OTHER_NAMES[own].includes(name))
    const found = sameBlock(this.registry, name, properties, older)
    if (found !== null) return found
    this.strange.add(name)
    return this.registry.blocksByName[solid ? STONE : AIR].defaultState
  }
}

/** A state as commands have it: a block alone is its default state, also on servers whose commands know no properties. */
function shortText (registry, states, state) {
  const { name } = states.describe(state)
  return registry.blocksByName[name].defaultState === state ? name : states.text(state)
}

/** @returns {number | null} the state of a block of one of these names, with those of the properties that it has */
function sameBlock (registry, name, properties, others) {
  const own = [name, ...others].find(each => registry.blocksByName[each] !== undefined)
  if (own === undefined) return null
  const block = registry.blocksByName[own]
  const has = new Set(block.states.map(each => each.name))
  try {
    return encode(registry, own, Object.fromEntries(Object.entries(properties).filter(([key]) => has.has(key))))
  } catch (error) {
    if (error instanceof RangeError) return block.defaultState
    throw error
  }
}

module.exports = { BlockMapping, held, heldFor, registryOf }
