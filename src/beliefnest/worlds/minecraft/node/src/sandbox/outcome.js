'use strict'
/** Outcome of a run, described for the program's author in lines and columns of the program's own text. */

const { NOT_AWAITED, nearName, notAwaited } = require('./hints')
const { cut } = require('./text')

const MAX_MESSAGE = 4000
const MAX_NAME = 100
// Largest length of a stack that is parsed; a program can make up a stack of any length.
const MAX_STACK = 20_000
const MAX_FRAMES = 100
const SKILL = /^[\w. ]{1,80}$/
const PLACE = /\(?program\.js:(\d+):(\d+)\)?/

/**
 * Describe the outcome of a run.
 * @param {{ok: boolean, error?: object, stray?: boolean, ended?: import('./engine').GuestEnded, full: boolean}} outcome
 *   outcome of the session; with `stray` the error is that of a promise without a handler, with `full` memory has grown
 *   to its limit
 * @param {{locate: function, callee: function, statement: function}} program
 * @param {{fuel: number, memory: number}} limits
 * @param {number} last number of the statement that was executed last; 0 for none
 * @param {string[]} [names] names in scope of the program
 * @param {string[]} [under] names of calls that had not ended
 * @returns {?{message: string, line: ?number, column: ?number, skill: ?string, kind: string}}
 */
function describeOutcome ({ ok, error, stray, ended, full }, program, limits, last, names = [], under = []) {
  if (ok) return null
  const { message, skill, kind, reason, stack } = ended ? ofEnd(ended, limits, full) : ofError(error, limits, full)
  const { place, callee } = placeIn(stack, program)
  const { line, column } = place ?? program.statement(last) ?? { line: null, column: null }
  return { message: cut(named(message, callee) + nearName(message, names) + notAwaited(message, under), MAX_MESSAGE) + (stray ? NOT_AWAITED : ''), line, column, skill, kind, ...(reason && { reason }) }
}

// The interpreter's message does not say which expression is not a function; add it.
function named (message, callee) {
  return message === 'TypeError: not a function' && callee !== null ? `TypeError: ${callee} is not a function` : message
}

function ofEnd ({ kind: how, message, guestStack }, limits, full) {
  // A promise whose job found no room is never settled.
  const kind = how === 'stuck' && full ? 'memory' : how
  return { message: limitMessage(kind, limits) ?? message, skill: null, kind, stack: guestStack }
}

function ofError (error, limits, full) {
  const { message, name, skill, stack, kind, reason } = plainError(error)
  // Without room even for its error about memory, the interpreter throws null.
  const lacksRoom = full && error?.thrown === true && error.name === 'object' && error.message === 'null'
  const limit = lacksRoom ? 'memory' : limitOf(name, message)
  if (limit) return { message: limitMessage(limit, limits), skill: null, kind: limit, stack }
  const prefix = name === 'Error' || kind !== null || message.startsWith(`${name}:`) ? '' : `${name}: `
  return { message: prefix + message, skill, kind: kind ?? 'error', reason, stack }
}

// The record comes from the guest: any field may have any value.
function plainError (record) {
  const field = (key, otherwise, most = MAX_MESSAGE) => typeof record?.[key] === 'string' ? cut(record[key], most) : otherwise
  const skill = field('skill', null)
  const thrown = record?.thrown === true
  return {
    message: thrown ? `the program threw ${field('message', 'something')}` : field('message', 'the program failed, and broke what would have said how'),
    name: thrown ? 'Error' : field('name', 'Error', MAX_NAME),
    skill: skill !== null && SKILL.test(skill) ? skill : null,
    kind: ['skill', 'refused'].includes(record?.kind) ? record.kind : null,
    reason: record?.reason === 'no_way' ? 'no_way' : null,
    stack: field('stack', '', MAX_STACK)
  }
}

function limitOf (name, message) {
  if (name !== 'InternalError') return null
  return { 'out of memory': 'memory', 'stack overflow': 'stack', interrupted: 'fuel' }[message] ?? null
}

function limitMessage (kind, { fuel, memory }) {
  switch (kind) {
    case 'fuel': return `fuel exhausted: the program computed more than its limit of ${fuel} units; is there an endless loop?`
    case 'memory': return `memory exhausted: the limit is ${Math.round(memory / 2 ** 20)} MiB`
    case 'stack': return 'stack overflow: the program calls itself too deeply; the limit is about 1000 calls'
    default: return null
  }
}

function placeIn (stack, program) {
  for (const frame of stack.slice(0, MAX_STACK).split('\n', MAX_FRAMES)) {
    const match = PLACE.exec(frame)
    const [line, column] = match ? [Number(match[1]), Number(match[2])] : []
    const place = match && program.locate(line, column)
    if (place) return { place, callee: program.callee(line, column) }
  }
  return { place: null, callee: null }
}

module.exports = { describeOutcome }
