'use strict'
/**
 * Aims of a program: the positions and agents that its calls ask the bot to walk to or to use. They are taken only
 * from the arguments of calls, whether or not the target can be reached.
 */

const using = place => ({ place, uses: true })
const handing = { agent: 1, uses: true }

/**
 * By skill: which argument is the position or the agent, counted from 0 with `bot`, and whether the skill uses the
 * target.
 */
const SKILLS = {
  goToPosition: { place: 1, uses: false },
  follow: { agent: 1, uses: false },
  getItemFromChest: using(1),
  depositItemIntoChest: using(1),
  mineBlock: using(1),
  placeItem: using(2),
  craftItem: using(2),
  smeltItem: using(3),
  turnOnLever: using(1),
  turnOffLever: using(1),
  pressButton: using(1),
  openDoor: using(1),
  closeDoor: using(1),
  giveItemToOther: handing,
  receiveItemFromOther: handing
}
const USING = new Set(['openContainer', 'openChest', 'openDispenser', 'openFurnace', 'openBlock', 'activateBlock', 'activateEntity', 'dig', 'sleep'])
const WALKING = new Set(['goto', 'setGoal'])
const LONGEST_NAME = 16

/**
 * Return the aim of a call of a skill; null if the call has none.
 * @returns {?{call: string, place: ?number[], agent: ?string, uses: boolean}}
 */
function aimOfSkill (name, args) {
  if (!Object.hasOwn(SKILLS, name)) return null
  const { place, agent, uses } = SKILLS[name]
  return aim(name, pointOf(args[place]), nameOf(args[agent]), uses)
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
