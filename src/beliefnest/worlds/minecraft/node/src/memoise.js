'use strict'
/**
 * Cache of one registry, one Block class, one Item class and so on per Minecraft version. The packages create new ones
 * on every call (for every bot), at 3 to 4 times the cost of everything else.
 */

// In the order in which the packages load one another.
const MEMOISED = [
  'minecraft-data', 'prismarine-registry', 'prismarine-biome', 'prismarine-block',
  'prismarine-chunk', 'prismarine-item', 'prismarine-windows', 'prismarine-entity',
  'prismarine-chat', 'prismarine-world', 'prismarine-recipe'
]

/**
 * Return a function that creates only one object per version.
 * @param {Function} make takes a version text or a registry
 * @returns {Function}
 */
function memoised (make) {
  const made = new Map()
  function remembered (versionOrRegistry, ...rest) {
    if (rest.length > 0 || !versionOrRegistry) return make(versionOrRegistry, ...rest)
    const key = typeof versionOrRegistry === 'object'
      ? versionOrRegistry.version.minecraftVersion
      : String(versionOrRegistry)
    if (!made.has(key)) made.set(key, make(versionOrRegistry))
    return made.get(key)
  }
  return Object.assign(remembered, make)
}

/** Memoise the installed packages, for a run from source; build.js does the same for the bundle. */
function memoiseInstalled () {
  for (const name of MEMOISED) {
    const path = require.resolve(name)
    require(path)
    require.cache[path].exports = memoised(require.cache[path].exports)
  }
}

module.exports = { MEMOISED, memoised, memoiseInstalled }
