'use strict'
/** Sandbox for untrusted programs. SECURITY.md says what it protects from and what not. */

const { Engine, GuestEnded } = require('./engine')
const { Session } = require('./session')
const { prepareProgram, ProgramSyntaxError } = require('./program')
const { describeOutcome } = require('./outcome')

const DEFAULTS = { fuel: 250_000_000, memory: 64 * 2 ** 20 }
const MAX_FUEL = 2_000_000_000
const GUEST_NAMES = ['Vec3', 'goals', 'Movements', 'located', 'absent', 'positionOf', 'blockAt']

/**
 * Compile the interpreter, once for any number of runs.
 * @param {{fuel?: number, memory?: number}} [options] limits of a run: fuel in loop turns and calls of the interpreter
 *   (about one per bytecode instruction), memory in bytes
 * @param {() => void} [alive] called now and then while a program computes within its limits
 * @returns {{run: function(object): Promise<object>, warm: function(object): Promise<void>, prepare: function():
 *   Promise<void>}} `run` as below; `warm` does the preparations of the first run of a scope, `prepare` those of the
 *   next run
 */
function createSandbox (options = {}, alive = () => {}) {
  const engine = new Engine(alive)
  const defaults = { ...DEFAULTS, ...options }
  const warm = async (scope) => { await engine.templateOf(namesOf(splitScope(scope))) }
  return { run: (request) => run(engine, { ...defaults, ...request }), warm, prepare: () => engine.prepare() }
}

/**
 * Run one program. Time, timers and random numbers are those of the process at the time of the call.
 * @param {Engine} engine
 * @param {object} request
 * @param {string} request.code body of an async function, or one whole function of `bot`
 * @param {object} request.bot Mineflayer bot; the program can use the parts that policy/ names
 * @param {Object<string, *>} request.scope skills by name (functions of the host), and `mcData`; other values are not
 *   handed over. Vec3, goals, Movements and the functions for claims are the guest's own
 * @param {AbortSignal} [request.signal] ends the program when aborted
 * @param {function(object): void} [request.aim] called with the program's aims (see aims.js)
 * @param {function(): number} [request.random] random numbers of the program, as Math.random; those of the process by
 *   default
 * @returns {Promise<{ok: boolean, error: ?{message: string, line: ?number, column: ?number, skill: ?string, kind:
 *   string, reason?: string}, lines: number[], log: {level: string, text: string}[], unfinished: {what: string, line:
 *   ?number}[], fuel: number}>} never rejects for a fault of the program. `kind` is syntax, error, skill (a skill or a
 *   call of the bot failed), refused (an argument that cannot be used), fuel, memory, stack, aborted or internal.
 *   `lines` are the executed lines, `unfinished` the calls and timers that had not ended, each with the line of the
 *   statement that began it, and `fuel` the fuel used
 */
async function run (engine, { code, bot, scope = {}, fuel, memory, signal, aim, random = () => Math.random() }) {
  if (!(fuel > 0 && fuel <= MAX_FUEL)) throw new RangeError(`the fuel must be between 1 and ${MAX_FUEL}, found ${fuel}`)
  const { skills, data } = splitScope(scope)
  const names = namesOf({ skills, data })
  let program
  try {
    program = prepareProgram(code, names.parameters)
  } catch (error) {
    if (!(error instanceof ProgramSyntaxError)) throw error
    const { message, line, column } = error
    return { ok: false, error: { message, line, column, skill: null, kind: 'syntax' }, lines: [], log: [], unfinished: [], fuel: 0 }
  }
  const guest = await engine.open({ fuel, memory }, names)
  const session = new Session(guest, { bot, skills, data, random, aim })
  const report = await observe(session, guest, program, { fuel, memory, signal, names: names.parameters })
  engine.close(guest)
  return report
}

async function observe (session, guest, program, { fuel, memory, signal, names }) {
  const abort = () => session.finish({ ok: false, ended: new GuestEnded('aborted', 'the program was ended from outside') })
  signal?.addEventListener('abort', abort, { once: true })
  if (signal?.aborted) abort()
  else session.begin(program)
  const outcome = await session.finished
  signal?.removeEventListener('abort', abort)
  return {
    ok: outcome.ok,
    error: describeOutcome({ ...outcome, full: guest.isFull }, program, { fuel, memory }, guest.lastStatement, names, session.underWay),
    lines: program.linesOf(guest.statements),
    log: session.log,
    unfinished: session.unfinished.map(({ what, statement }) => ({ what, line: program.statement(statement)?.line ?? null })),
    fuel: guest.fuelAtEnd
  }
}

/** Return the scope's names. @returns {import('./engine').Scope} */
function namesOf ({ skills, data }) {
  const names = Object.keys(skills)
  return { parameters: ['bot', ...GUEST_NAMES, ...(data ? ['mcData'] : []), ...names], skills: names, data: data !== null }
}

function splitScope (scope) {
  const skills = {}
  for (const [name, value] of Object.entries(scope)) {
    if (typeof value === 'function' && !GUEST_NAMES.includes(name)) skills[name] = value
  }
  return { skills, data: scope.mcData ?? null }
}

module.exports = { DEFAULTS, createSandbox, namesOf }
