'use strict'
/** Kinds of host objects, as the policy names them. */

/**
 * Return the kind of a host object.
 * @param {object} value
 * @param {object} bot the program's own bot; other bots have no kind
 * @returns {?string} values of the kinds `block` and `item` are copied to the guest, others get handles; null for
 *   plain data and foreign objects
 */
function kindOf (value, bot) {
  if (value === bot) return 'bot'
  if (value === bot.pathfinder) return 'pathfinder'
  if (value === bot.entity || isEntity(value, bot)) return 'entity'
  if (typeof value.getProperties === 'function' && typeof value.stateId === 'number') return 'block'
  if (typeof value.emptySlotCount === 'function' && Array.isArray(value.slots)) return 'window'
  if (typeof value.stackSize === 'number' && typeof value.count === 'number' && typeof value.type === 'number') return 'item'
  if (Array.isArray(value.delta) && typeof value.requiresTable === 'boolean') return 'recipe'
  return null
}

function isEntity (value, bot) {
  return typeof value.id === 'number' && bot.entities !== undefined && bot.entities[value.id] === value
}

module.exports = { kindOf }
