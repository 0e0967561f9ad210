'use strict'
/** Goals and movements of mineflayer-pathfinder, built in the host from a program's description. */

const { goals, Movements } = require('mineflayer-pathfinder')

const MAX_SUBGOALS = 100
const MAX_RANGE = 256
const MAX_DEPTH = 10
const coordinate = (exchange, wire, where) => exchange.coordinate(wire, where)
const range = (exchange, wire, where) => {
  const value = exchange.number(wire, where)
  if (value < 0 || value > MAX_RANGE) throw new TypeError(`${where} must be between 0 and ${MAX_RANGE}, found ${value}`)
  return value
}
const vector = (exchange, wire, where) => exchange.vector(wire, where)
const entity = (exchange, wire, where) => exchange.object(wire, ['entity'], where)
const goal = (exchange, wire, where, depth) => buildGoal(exchange, wire, where, depth)
const goalList = (exchange, wire, where, depth) => {
  const list = Array.isArray(wire) ? wire : []
  if (list.length === 0 || list.length > MAX_SUBGOALS) throw new TypeError(`${where} must be 1 to ${MAX_SUBGOALS} goals`)
  return list.map((item, i) => buildGoal(exchange, item, `${where}[${i}]`, depth))
}
const reach = { range: [range, 5], LOS: [boolean, true] }
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
  GoalLookAtBlock: { args: [vector], world: true, options: { reach: [range, 4.5], entityHeight: [range, 1.6] } },
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
  if (!['north', 'south', 'east', 'west', 'up', 'down'].includes(text)) throw new TypeError(`${where} must be a direction, found ${text}`)
  return text
}

function half (exchange, wire, where) {
  const text = exchange.text(wire, where)
  if (!['top', 'bottom'].includes(text)) throw new TypeError(`${where} must be "top" or "bottom", found ${text}`)
  return text
}

/** Names of the goals a program can make. */
const GOAL_NAMES = Object.keys(FORMS)

/**
 * @param {import('./exchange').Exchange} exchange
 * @param {object} wire `{$: 'g', n: name, a: arguments}`
 * @param {string} where for messages
 * @returns {object} a goal of mineflayer-pathfinder
 */
function buildGoal (exchange, wire, where, depth = 0) {
  if (depth > MAX_DEPTH) throw new TypeError(`${where} is nested more than ${MAX_DEPTH} deep`)
  if (wire === null || typeof wire !== 'object' || wire.$ !== 'g' || !Object.hasOwn(FORMS, wire.n) || !Array.isArray(wire.a)) {
    throw new TypeError(`${where} must be a goal, such as new goals.GoalNear(x, y, z, range)`)
  }
  const form = FORMS[wire.n]
  const args = form.args.map((convert, i) => convert(exchange, wire.a[i] ?? null, `argument ${i + 1} of ${wire.n}`, depth + 1))
  if (form.world) args.push(exchange.bot.world, goalOptions(exchange, form, wire))
  return new goals[wire.n](...args)
}

function goalOptions (exchange, { options }, wire) {
  const written = wire.a.slice(1).find((item) => item !== null && typeof item === 'object' && item.$ === 'o')
  const values = new Map(written ? written.o : [])
  return Object.fromEntries(Object.entries(options).map(([name, [convert, otherwise]]) =>
    [name, values.has(name) ? convert(exchange, values.get(name), `option ${name} of ${wire.n}`) : otherwise]))
}

/**
 * @param {import('./exchange').Exchange} exchange
 * @param {object} wire `{$: 'm', o: [[name, value]...]}`, switches and costs of Movements
 * @returns {object} movements of mineflayer-pathfinder: the bot's standard ones, changed as described
 */
function buildMovements (exchange, wire, where) {
  if (wire === null || typeof wire !== 'object' || wire.$ !== 'm' || !Array.isArray(wire.o)) {
    throw new TypeError(`${where} must be made with new Movements(bot)`)
  }
  const movements = new Movements(exchange.bot)
  const standard = exchange.bot.pathfinder.movements
  for (const name of [...SWITCHES, ...COSTS, 'scafoldingBlocks']) movements[name] = standard[name]
  for (const [name, value] of wire.o) {
    if (SWITCHES.includes(name)) movements[name] = boolean(exchange, value, `Movements.${name}`)
    else if (COSTS.includes(name)) movements[name] = exchange.number(value, `Movements.${name}`)
    else throw new TypeError(`Movements.${String(name).slice(0, 40)} cannot be set by a program; ${[...SWITCHES, ...COSTS].join(', ')} can`)
  }
  return movements
}

module.exports = { buildGoal, buildMovements, GOAL_NAMES }
