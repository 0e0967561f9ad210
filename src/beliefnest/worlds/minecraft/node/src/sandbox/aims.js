'use strict'
/**
 * Aims of a program: the positions and agents that its calls ask the bot to walk to or to use. They are taken only
 * from the arguments of calls, whether or not the target can be reached.
 */

const { BY_NAME } = require('../../../../../skills/code')

const USING = new Set(['openContainer', 'openChest', 'openDispenser', 'openFurnace', 'openBlock', 'activateBlock', 'activateEntity', 'dig', 'sleep'])
const WALKING = new Set(['goto', 'setGoal'])
const LONGEST_NAME = 16

/**
 * Return the aim of a call of a skill; null if the call has none.
 * @returns {?{call: string, place: ?number[], agent: ?string, uses: boolean}}
 */
function aimOfSkill (name, args) {
  const parameters = BY_NAME.get(name)?.parameters ?? []
  const target = parameters.findIndex(parameter => parameter.aim !== undefined)
  if (target === -1) return null
  const { type, aim: manner } = parameters[target]
  const isAgent = type === 'string'
  return aim(name, isAgent ? null : pointOf(args[target]), isAgent ? nameOf(args[target]) : null, manner === 'uses')
}

/** Return the aim of a call of the bot or of its pathfinder. */
function aimOfCall (name, [target]) {
  if (!target || typeof target !== 'object') return null
  if (USING.has(name)) return aim(name, pointOf(target.position), nameOf(target.username), true)
  if (!WALKING.has(name)) return null
  const place = pointOf(target.entity?.position) ?? pointOf(target.pos) ?? pointOf(target)
  return aim(name, place, nameOf(target.entity?.username), false)
}

function aim (call, place, agent, uses) {
  return place === null && agent === null ? null : { call, place, agent, uses }
}

function pointOf (value) {
  const parts = [value?.x, value?.y, value?.z]
  return parts.every(Number.isFinite) ? parts : null
}

const nameOf = value => (typeof value === 'string' && value.length <= LONGEST_NAME ? value : null)

module.exports = { aimOfCall, aimOfSkill }
