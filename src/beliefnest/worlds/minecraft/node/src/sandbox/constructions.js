'use strict'
/** Construction of mineflayer-pathfinder's goals and movements in the host, from a program's description. */

const { goals, Movements } = require('mineflayer-pathfinder')

const { cut } = require('./text')

const MAX_GOALS = 100
const MAX_RANGE = 256
const MAX_DEPTH = 10
// Largest reach; a player reaches no further, and rays are no longer.
const MAX_REACH = 8
// Fuel for the ray check of a goal at each near enough position of a path, and for making a Movements object.
const RAYS_COST = 5000
const MOVEMENTS_COST = 200_000
const coordinate = (exchange, wire, where) => exchange.coordinate(wire, where)
const upTo = (most) => (exchange, wire, where) => {
  const value = exchange.number(wire, where)
  if (value < 0 || value > most) throw new TypeError(`${where} must be between 0 and ${most}, found ${value}`)
  return value
}
const range = upTo(MAX_RANGE)
const near = upTo(MAX_REACH)
const vector = (exchange, wire, where) => exchange.vector(wire, where)
const entity = (exchange, wire, where) => exchange.object(wire, ['entity'], where)
const goal = (exchange, wire, where, tree) => buildGoal(exchange, wire, where, tree)
const goalList = (exchange, wire, where, tree) => {
  const list = Array.isArray(wire) ? wire : []
  if (list.length === 0 || list.length > MAX_GOALS) throw new TypeError(`${where} must be 1 to ${MAX_GOALS} goals`)
  return list.map((item, i) => buildGoal(exchange, item, `${where}[${i}]`, tree))
}
const reach = { range: [near, 5], LOS: [boolean, true] }
const placing = { ...reach, facing: [facing, undefined], half: [half, undefined] }

const xyz = [coordinate, coordinate, coordinate]
const FORMS = {
  GoalBlock: { args: xyz },
  GoalNear: { args: [...xyz, range] },
  GoalXZ: { args: [coordinate, coordinate] },
  GoalNearXZ: { args: [coordinate, coordinate, range] },
  GoalY: { args: [coordinate] },
  GoalGetToBlock: { args: xyz },
  GoalFollow: { args: [entity, range] },
  GoalInvert: { args: [goal] },
  GoalCompositeAny: { args: [goalList] },
  GoalCompositeAll: { args: [goalList] },
  GoalLookAtBlock: { args: [vector], world: true, options: { reach: [near, 4.5], entityHeight: [near, 1.6] } },
  GoalPlaceBlock: { args: [vector], world: true, options: placing }
}

const SWITCHES = ['canDig', 'dontCreateFlow', 'dontMineUnderFallingBlock', 'allow1by1towers', 'allowFreeMotion',
  'allowParkour', 'allowSprinting', 'allowEntityDetection', 'canOpenDoors', 'infiniteLiquidDropdownDistance']
const COSTS = ['digCost', 'placeCost', 'liquidCost', 'entityCost', 'maxDropDown']

function boolean (exchange, wire, where) {
  if (typeof wire !== 'boolean') throw new TypeError(`${where} must be true or false`)
  return wire
}

function facing (exchange, wire, where) {
  const text = exchange.text(wire, where)
  if (!['north', 'south', 'east', 'west', 'up', 'down'].includes(text)) throw new TypeError(`${where} must be a direction, found ${cut(text, 40)}`)
  return text
}

function half (exchange, wire, where) {
  const text = exchange.text(wire, where)
  if (!['top', 'bottom'].includes(text)) throw new TypeError(`${where} must be "top" or "bottom", found ${cut(text, 40)}`)
  return text
}

/** Names of the goals that a program can make. */
const GOAL_NAMES = Object.keys(FORMS)

/**
 * Build a goal from its description.
 * @param {import('./exchange').Exchange} exchange
 * @param {object} wire `{$: 'g', n: name, a: arguments}`
 * @param {string} where name of the value for messages
 * @returns {object} goal of mineflayer-pathfinder
 */
function buildGoal (exchange, wire, where, { depth, made } = { depth: 0, made: { goals: 0 } }) {
  if (++made.goals > MAX_GOALS) throw new TypeError(`${where} is one of more than ${MAX_GOALS} goals in one`)
  if (depth > MAX_DEPTH) throw new TypeError(`${where} is nested more than ${MAX_DEPTH} deep`)
  if (wire === null || typeof wire !== 'object' || wire.$ !== 'g' || !Object.hasOwn(FORMS, wire.n) || !Array.isArray(wire.a)) {
    throw new TypeError(`${where} must be a goal, such as new goals.GoalNear(x, y, z, range)`)
  }
  const form = FORMS[wire.n]
  const args = form.args.map((convert, i) => convert(exchange, wire.a[i] ?? null, `argument ${i + 1} of ${wire.n}`, { depth: depth + 1, made }))
  if (form.world) args.push(exchange.bot.world, goalOptions(exchange, form, wire))
  if (form.world) exchange.pay(RAYS_COST)
  const built = new goals[wire.n](...args)
  if (form.world) payForRays(exchange, built)
  return built
}

/**
 * Charge fuel for the rays of a goal. When the fuel is used up, the goal counts as reached, so that the search ends at
 * once.
 */
function payForRays (exchange, goal) {
  const { isEnd, pos } = goal
  goal.isEnd = (node) => {
    if (node.distanceTo(pos) > 2 * MAX_REACH + 1) return false
    return exchange.spend(RAYS_COST) ? isEnd.call(goal, node) : true
  }
}

function goalOptions (exchange, { options }, wire) {
  const written = wire.a.slice(1).find((item) => item !== null && typeof item === 'object' && item.$ === 'o')
  const values = new Map(written ? written.o : [])
  return Object.fromEntries(Object.entries(options).map(([name, [convert, otherwise]]) =>
    [name, values.has(name) ? convert(exchange, values.get(name), `option ${name} of ${wire.n}`) : otherwise]))
}

/**
 * Build movements from a description.
 * @param {import('./exchange').Exchange} exchange
 * @param {object} wire `{$: 'm', o: [[name, value]...]}`: switches and costs of Movements
 * @returns {object} the bot's standard movements with the described changes
 */
function buildMovements (exchange, wire, where) {
  if (wire === null || typeof wire !== 'object' || wire.$ !== 'm' || !Array.isArray(wire.o)) {
    throw new TypeError(`${where} must be made with new Movements(bot)`)
  }
  exchange.pay(MOVEMENTS_COST)
  const movements = new Movements(exchange.bot)
  const standard = exchange.bot.pathfinder.movements
  for (const name of [...SWITCHES, ...COSTS, 'scafoldingBlocks']) movements[name] = standard[name]
  for (const [name, value] of wire.o) {
    if (SWITCHES.includes(name)) movements[name] = boolean(exchange, value, `Movements.${name}`)
    else if (COSTS.includes(name)) movements[name] = exchange.number(value, `Movements.${name}`)
    else throw new TypeError(`Movements.${typeof name === 'string' ? cut(name, 40) : '?'} cannot be set by a program; ${[...SWITCHES, ...COSTS].join(', ')} can`)
  }
  return movements
}

module.exports = { buildGoal, buildMovements, GOAL_NAMES }
