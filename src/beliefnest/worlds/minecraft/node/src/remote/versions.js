'use strict'
/**
 * Minecraft versions of remote servers. The rest of the code uses this build's own version; a server's blocks are
 * mapped to those of the same names and properties.
 */
const minecraftData = require('minecraft-data')
const { pc: data } = require('minecraft-data/data')
const { BadRequest } = require('../channel/errors')
const { rememberBlocks } = require('../blocks')
const { blockStates, encode } = require('../server/plugins/lib/states')

// Other names of our blocks in older and newer versions.
const OTHER_NAMES = { short_grass: ['grass'], chain: ['iron_chain'], dirt_path: ['grass_path'] }
const AIR = 'air'
const STONE = 'stone'

/** Return the versions whose data this build has. */
const installedVersions = () => Object.keys(data).filter(version => /^\d+\.\d+(\.\d+)?$/.test(version))

/**
 * Return the held version for a version or protocol number.
 * @param {number | string} spoken protocol number, or a version
 * @returns {string | null} null if no held version speaks it
 */
function heldFor (spoken) {
  if (installedVersions().includes(spoken)) return spoken
  const versions = minecraftData.versions.pc
  const protocol = typeof spoken === 'number' ? spoken : versions.find(({ minecraftVersion }) => minecraftVersion === spoken)?.version
  if (protocol === undefined) return null
  const same = versions.filter(({ version, usesNetty }) => version === protocol && usesNetty).map(({ minecraftVersion }) => minecraftVersion)
  return same.find(version => installedVersions().includes(version)) ?? null
}

/** Return the registry of a held version. @returns {object} */
function registryOf (version) {
  const registry = require('prismarine-registry')(version)
  rememberBlocks(registry)
  return registry
}

/** Mapping of block states between our version and a server's. */
class BlockMapping {
  /**
   * @param {object} registry registry of our version
   * @param {object} theirs registry of the server's version
   */
  constructor (registry, theirs) {
    this.isSame = registry.version.minecraftVersion === theirs.version.minecraftVersion
    this.registry = registry
    this.theirs = theirs
    this.states = blockStates(registry)
    this.theirStates = blockStates(theirs)
    this.translated = new Map()
    // Names of the server's blocks that our version lacks; they are mapped to stone, or to air if they are passable.
    this.strange = new Set()
  }

  /** Return our state for a state of the server. @returns {number} */
  fromServer (state) {
    if (this.isSame) return state
    if (!this.translated.has(state)) this.translated.set(state, this.mapped(state))
    return this.translated.get(state)
  }

  /**
   * Return the text of one of our states for the server's commands.
   * @returns {string}
   * @throws {BadRequest} if the server lacks the block
   */
  textForServer (state) {
    if (this.isSame) return shortText(this.registry, this.states, state)
    const { name, properties } = this.states.describe(state)
    const block = sameBlock(this.theirs, name, properties, OTHER_NAMES[name] ?? [])
    if (block === null) throw new BadRequest(`the server's Minecraft ${this.theirs.version.minecraftVersion} has no block ${name}; use another block in the scenario`)
    return shortText(this.theirs, this.theirStates, block)
  }

  mapped (state) {
    const { name, properties, solid } = this.theirStates.describe(state)
    const older = Object.keys(OTHER_NAMES).filter(own => OTHER_NAMES[own].includes(name))
    const block = sameBlock(this.registry, name, properties, older)
    if (block !== null) return block
    this.strange.add(name)
    return this.registry.blocksByName[solid ? STONE : AIR].defaultState
  }
}

/**
 * Return the text of a state for commands. A default state is only a name, also for servers whose commands know no
 * properties.
 */
function shortText (registry, states, state) {
  const { name } = states.describe(state)
  return registry.blocksByName[name].defaultState === state ? name : states.text(state)
}

/**
 * Return the state of a block with one of these names and as many of the given properties as it has; null if there is
 * none.
 * @returns {number | null}
 */
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

module.exports = { BlockMapping, installedVersions, heldFor, registryOf }
