'use strict'
/**
 * The host's side of the sandbox for hosts that are not written in JavaScript, such as the scripted world: preparation of
 * programs, checks of what they ask for, descriptions of their outcomes. No program runs here, and nothing here knows a
 * world. The build makes one text of this file, which runs inside an interpreter of its own; arguments and results of its
 * functions are JSON.
 */
const { Vec3 } = require('vec3')
const { BY_NAME, SkillError, admitted } = require('../../../../../skills/code')
const { aimOfCall, aimOfSkill } = require('./aims')
const { Exchange, RefusedError, describeWire } = require('./exchange')
const { describeOutcome } = require('./outcome')
const { COST, kinds } = require('./policy/kinds')
const { prepareProgram, ProgramSyntaxError } = require('./program')
const { cut } = require('./text')

const LONGEST_ERROR = 4000
const LONGEST_NAME = 100

const MOST_PROGRAMS = 200

const programs = new Map()
const registry = { itemsByName: {}, blocksByName: {} }

/** Stand-in for an object of the game. */
class GameObject {
  constructor (members) {
    Object.assign(this, members)
  }
}

/** Take the names of all items, and blocks with their properties, as minecraft-data lists them. */
function know ({ items, blocks }) {
  for (const name of items) registry.itemsByName[name] = { name }
  for (const [name, states] of Object.entries(blocks)) registry.blocksByName[name] = { name, states }
}

/** Return a prepared program. The latest ones are kept. */
function programOf (code, names) {
  const program = programs.get(code) ?? prepareProgram(code, names)
  programs.set(code, program)
  if (programs.size > MOST_PROGRAMS) programs.delete(programs.keys().next().value)
  return program
}

/** Prepare a program. @returns {object} `{text, marks}`, or `{error}` */
function prepare (code, names) {
  try {
    const { text, marks } = programOf(code, names)
    return { text, marks }
  } catch (error) {
    if (!(error instanceof ProgramSyntaxError)) throw error
    const { message, line, column } = error
    return { error: { message, line, column, skill: null, kind: 'syntax' } }
  }
}

/** Return the line of a statement, or null. */
function lineOf (code, names, statement) {
  return programOf(code, names).statement(statement)?.line ?? null
}

/** Describe the outcome of a program, as describeOutcome does. */
function outcome (code, names, result, limits, last, under) {
  return describeOutcome(result, programOf(code, names), limits, last, names, under)
}

/**
 * Check a call of a skill.
 * @param {string} name
 * @param {Array} wires arguments as the program's side wrote them
 * @param {object} facts as for `exchangeOf`
 * @returns {object} `{own, checked, aim, cost}`: the arguments without the bot, those that the skill gets, and the aim of
 *   the call; or `{error, cost}`, and with `later` true the error is that of the promise
 */
function admitSkill (name, wires, facts) {
  const cost = COST[BY_NAME.get(name).cost ?? 'call']
  const exchange = exchangeOf(facts)
  return answered(cost, name, () => {
    const args = wires.map((wire, i) => exchange.toHost(wire, `argument ${i + 1} of ${name}`))
    const aim = aimOfSkill(name, args)
    try {
      const { own, checked } = admitted(BY_NAME.get(name), { bot: exchange.bot, Vec3 }, args)
      return { own: own.map(plain), checked: checked.map(plain), aim }
    } catch (error) {
      if (!(error instanceof SkillError)) throw error
      return { error: outcomeOf(error, name), aim, later: true }
    }
  })
}

/** Check a call of a method of a game object; arguments and result as for `admitSkill`. */
function admitCall (kind, name, wires, facts) {
  if (!Object.hasOwn(kinds[kind].call, name)) return { error: outcomeOf(new RefusedError(`${kind} has no call ${describeWire(name)}`), null), cost: 0 }
  const [types, , cost = COST.call] = kinds[kind].call[name]
  const exchange = exchangeOf(facts)
  return answered(typeof cost === 'function' ? COST.call : cost, `${kind}.${name}`, () => {
    const args = types.map((type, i) => type.toHost(exchange, i in wires ? wires[i] : { $: 'u' }, `argument ${i + 1} of ${kind}.${name}`))
    return { own: args.map(plain), checked: args.map(plain), aim: aimOfCall(name, args) }
  })
}

/** Return the error for a program that asks for what this world does not have. */
function refusal (message, label) {
  return outcomeOf(new RefusedError(message), label)
}

function answered (cost, label, act) {
  try {
    return { cost, ...act() }
  } catch (error) {
    return { cost, error: outcomeOf(error, label) }
  }
}

/**
 * Return the border of a program.
 * @param {{me: string, agents: string[], kinds: string[]}} facts name of its agent, all agents, and the kind of each game
 *   object that the program holds
 */
function exchangeOf ({ me, agents, kinds: kindsInUse }) {
  const bot = new GameObject({ username: me, registry, players: Object.fromEntries(agents.map(name => [name, {}])), blockAt: position => new GameObject({ position }) })
  const exchange = new Exchange({ bot, functionFor: () => () => undefined, kindOf: () => null, spend: () => true })
  exchange.handle(bot, 'bot')
  for (const kind of kindsInUse.slice(1)) exchange.handle(new GameObject({ kind }), kind)
  return exchange
}

/** Return a checked argument as plain data: positions as lists, items and blocks as their names, counted items by name. */
function plain (value) {
  if (value === null || typeof value !== 'object') return value
  if (value instanceof Vec3) return [value.x, value.y, value.z]
  if (isEntry(value)) return value.name
  if (!Array.isArray(value)) return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, plain(part)]))
  if (value.length > 0 && value.every(pair => Array.isArray(pair) && isEntry(pair[0]))) {
    return Object.fromEntries(value.map(([{ name }, count]) => [name, count]))
  }
  return value.map(plain)
}

const isEntry = value => value !== null && typeof value === 'object' && (registry.itemsByName[value.name] === value || registry.blocksByName[value.name] === value)

function outcomeOf (error, skill) {
  const name = error instanceof RefusedError ? 'Error' : cut(String(error.name), LONGEST_NAME)
  return { $: 'e', message: cut(String(error.message), LONGEST_ERROR), name, skill, kind: error instanceof RefusedError ? 'refused' : 'skill' }
}

const functions = { know, prepare, lineOf, outcome, admitSkill, admitCall, refusal }

/** Call a function by a text. @returns {string} */
function dispatch (text) {
  const [name, ...args] = JSON.parse(text)
  return JSON.stringify(functions[name](...args) ?? null)
}

module.exports = { dispatch }
