'use strict'
/**
 * Session of one run of a program: it answers the guest's requests, wakes the guest when something it waits for has
 * happened, and releases everything when the run ends.
 */

const { describeWire, Exchange, RefusedError } = require('./exchange')
const { COST, kinds, tables } = require('./policy/kinds')
const { events } = require('./policy/events')
const { GuestEnded } = require('./engine')
const { stateOf } = require('./policy/types')
const { kindOf } = require('./kind-of')
const { aimOfCall, aimOfSkill } = require('./aims')
const { cut, parsed, tooMuch } = require('./text')
const { BY_NAME } = require('../../../../../skills/code')

const LIMITS = { message: 1_000_000, calls: 100, timers: 1000, listeners: 100, logLines: 1000, logCharacters: 50_000, error: 4000, name: 100, level: 10 }
// Ticket of callbacks of listeners and timers, for whose results nobody waits.
const NOBODY = 0
const REQUEST_COST = { each: 1500, character: 20, answered: 2 }

class Session {
  /**
   * @param {import('./engine').Guest} guest
   * @param {{bot: object, skills: Object<string, function>, data: ?object, random: function(): number, aim:
   *   function(object): void}} world `data` has the tables of minecraft-data; `aim` is called with the program's aims
   */
  constructor (guest, { bot, skills, data, random, aim = () => {} }) {
    this.guest = guest
    this.bot = bot
    this.skills = skills
    this.data = data
    this.random = random
    this.aim = aim
    this.exchange = new Exchange({
      bot, functionFor: (id) => this.functionFor(id), kindOf: (value) => kindOf(value, bot), spend: (units) => this.spend(units)
    })
    this.calls = new Map()
    this.timers = new Map()
    this.listeners = []
    this.tickets = new Map()
    this.places = new WeakMap()
    this.nextId = 1
    this.log = []
    this.logRoom = LIMITS.logCharacters
    this.outcome = null
    this.unfinished = []
    this.underWay = []
    this.finished = new Promise((resolve) => { this.resolve = resolve })
  }

  /**
   * Start the program.
   * @param {{text: string, marks: number}} program
   */
  begin (program) {
    const world = { host: (text) => this.answer(text), now: () => Date.now(), random: this.random }
    this.exchange.handle(this.bot, 'bot')
    try {
      this.guarded(() => {
        this.guest.start(program, world)
        this.look()
      })
    } catch (error) {
      if (!(error instanceof GuestEnded)) throw error
    }
  }

  // Check whether the program has ended, or waits for something that can no longer happen.
  look () {
    const result = this.guest.result()
    const stray = result?.ok === false ? null : this.guest.strayError()
    if (stray !== null) this.finish({ ok: false, error: stray, stray: true })
    else if (result !== null) this.finish(result)
    else if (this.calls.size + this.timers.size + this.listeners.length === 0) {
      this.finish({ ok: false, ended: new GuestEnded('stuck', 'the program waits for a promise that nothing will settle') })
    }
  }

  /** End the run with an outcome; only the first outcome counts. */
  finish (outcome) {
    if (this.outcome !== null) return
    this.outcome = outcome
    this.underWay = Array.from(this.calls.values(), ({ what }) => what)
    this.unfinished = [...this.calls.values(), ...this.timers.values()].map(({ what, statement }) => ({ what, statement }))
    for (const { stop } of this.timers.values()) stop()
    this.timers.clear()
    for (const { event, listener } of this.listeners) this.bot.removeListener(event, listener)
    this.guest.end('ended', 'the program has ended')
    this.resolve(outcome)
  }

  /**
   * Charge fuel for work of the host for which no code of the program waits, such as a path search.
   * @returns {boolean} true if the program continues
   */
  spend (units) {
    if (this.outcome === null && this.guest.charge(units) === false) {
      this.finish({ ok: false, ended: new GuestEnded('fuel', 'the host has used it up on behalf of the program') })
    }
    return this.outcome === null
  }

  guarded (act) {
    try {
      return act()
    } catch (error) {
      if (!(error instanceof GuestEnded)) throw error
      this.finish({ ok: false, ended: error })
      throw error
    }
  }

  // No caller can catch an error of a message that the host sends by itself, so it ends the run here.
  wake (message) {
    if (this.outcome !== null) return
    try {
      this.guarded(() => {
        const { ok, value } = this.guest.send(message, LIMITS.message)
        if (!ok) this.finish({ ok: false, error: value })
        else if (this.guest.idle) this.look()
      })
    } catch (error) {
      if (!(error instanceof GuestEnded)) throw error
    }
  }

  answer (text) {
    try {
      this.guest.charge(REQUEST_COST.each + REQUEST_COST.character * Math.min(text.length, LIMITS.message))
      if (text.length > LIMITS.message) {
        throw new RefusedError(tooMuch(LIMITS.message))
      }
      const [action, ...args] = parsed(text)
      if (typeof action !== 'string' || !Object.hasOwn(HANDLERS, action)) throw new RefusedError('the request is of an unknown form')
      const answer = JSON.stringify({ ok: true, value: HANDLERS[action](this, ...args) })
      this.guest.charge(REQUEST_COST.answered * answer.length)
      return answer
    } catch (error) {
      const [cause, label] = error instanceof CallError ? [error.cause, error.label] : [error, null]
      return JSON.stringify({ ok: false, value: this.errorToGuest(cause, label) })
    }
  }

  errorToGuest (error, skill) {
    const isError = error !== null && typeof error === 'object' && typeof error.message === 'string'
    const message = cut(isError ? error.message : primitive(error), LIMITS.error)
    const name = isError && typeof error.name === 'string' && error.name !== 'RefusedError' ? cut(error.name, LIMITS.name) : 'Error'
    const place = isError ? this.places.get(error) ?? this.places.get(error.cause) : undefined
    const reason = reasonOf(error)
    return { $: 'e', message, name, skill, kind: error instanceof RefusedError ? 'refused' : 'skill', ...(reason && { reason }), stack: place }
  }

  /** Return the number under which the guest waits for a promise of the host. */
  promiseToGuest (promise, label, toGuest) {
    if (this.calls.size >= LIMITS.calls) throw new RefusedError(`${LIMITS.calls} calls are under way, which is the limit`)
    const id = this.nextId++
    this.calls.set(id, { what: label, statement: this.guest.lastStatement })
    const settle = (ok, convert) => {
      this.calls.delete(id)
      if (this.outcome === null) this.wake(['settle', id, ...this.converted(ok, convert, label)])
    }
    promise.then((value) => settle(true, () => toGuest(value)), (error) => settle(false, () => this.errorToGuest(error, label)))
    return { $: 'p', id }
  }

  converted (ok, convert, label) {
    try {
      return [ok, convert()]
    } catch (error) {
      return [false, this.errorToGuest(error, label)]
    }
  }

  /** Return a function of the program for the host. Its errors and promises become the host's. */
  functionFor (id) {
    return (...args) => {
      if (this.outcome !== null) throw new GuestEnded('ended', 'the program has ended')
      const ticket = this.nextId++
      const wires = args.map((arg, i) => this.exchange.toGuest(arg, `argument ${i + 1} of the callback`))
      const later = new Promise((resolve, reject) => this.tickets.set(ticket, { resolve, reject }))
      const { ok, value } = this.guarded(() => this.guest.send(['invoke', id, wires, ticket], LIMITS.message))
      if (ok && value.later) return later
      this.tickets.delete(ticket)
      if (!ok) throw this.errorOfGuest(value)
      return this.exchange.toHost(value.now, 'the result of the callback')
    }
  }

  errorOfGuest ({ message, name, stack }) {
    const error = new Error(cut(primitive(message), LIMITS.error))
    error.name = cut(primitive(name), LIMITS.name)
    this.places.set(error, cut(primitive(stack ?? ''), LIMITS.error))
    return error
  }

  settled (ticket, ok, wire) {
    if (ticket === NOBODY) {
      if (!ok) this.finish({ ok: false, error: wire })
      return null
    }
    const waiting = this.tickets.get(ticket)
    if (waiting === undefined) throw new RefusedError('nobody waits for that callback')
    // A value that cannot be used throws here and leaves the ticket; the guest then reports the error for it.
    const value = ok ? this.exchange.toHost(wire, 'the result of the callback') : null
    this.tickets.delete(ticket)
    if (ok) waiting.resolve(value)
    else waiting.reject(this.errorOfGuest(wire))
    return null
  }

  member (handle, table, name) {
    const { object, kind } = this.exchange.resolve(handle)
    const members = kinds[kind][table] ?? {}
    if (typeof name !== 'string' || !Object.hasOwn(members, name)) throw new RefusedError(`${kind} has no ${table} ${describeWire(name)}`)
    return { object, where: `${kind}.${name}`, entry: members[name] }
  }

  get (handle, name) {
    const { object, where, entry } = this.member(handle, 'get', name)
    const value = object[name]
    return value === undefined || value === null ? this.exchange.toGuest(value, where) : entry.toGuest(this.exchange, value, where)
  }

  set (handle, name, wire) {
    const { object, where, entry } = this.member(handle, 'set', name)
    object[name] = entry.toHost(this.exchange, wire, where)
    return null
  }

  call (handle, name, wires) {
    const { object, where, entry: [types, result, cost = COST.call] } = this.member(handle, 'call', name)
    if (typeof object[name] !== 'function') throw new RefusedError(`${where} is not there`)
    return this.outcomeOf(where, () => {
      const args = types.map((type, i) => type.toHost(this.exchange, missing(i, wires), `argument ${i + 1} of ${where}`))
      this.guest.charge(typeof cost === 'function' ? cost(args) : cost)
      this.make(aimOfCall(name, args))
      return object[name](...trimmed(args))
    }, result)
  }

  callSkill (name, wires) {
    if (typeof name !== 'string' || !Object.hasOwn(this.skills, name)) throw new RefusedError('there is no such skill')
    const type = { toGuest: (exchange, value) => exchange.toGuest(value, `the result of ${name}`) }
    this.guest.charge(COST[BY_NAME.get(name)?.cost ?? 'call'])
    return this.outcomeOf(name, () => {
      const args = wires.map((wire, i) => this.exchange.toHost(wire, `argument ${i + 1} of ${name}`))
      this.make(aimOfSkill(name, args))
      return this.skills[name](...args)
    }, type)
  }

  make (aim) {
    if (aim !== null) this.aim(aim)
  }

  outcomeOf (label, act, type) {
    let value
    try {
      value = act()
    } catch (error) {
      throw new CallError(label, error)
    }
    const toGuest = (result) => result === undefined || result === null
      ? this.exchange.toGuest(result, label)
      : type.toGuest(this.exchange, result, label)
    return isThenable(value) ? this.promiseToGuest(Promise.resolve(value), label, toGuest) : toGuest(value)
  }

  listen (event, wire, once) {
    if (typeof event !== 'string' || !Object.hasOwn(events, event)) throw new RefusedError(`a program cannot listen to the event ${describeWire(event)}; it can to ${Object.keys(events).join(', ')}`)
    if (this.listeners.length >= LIMITS.listeners) throw new RefusedError(`the program has ${LIMITS.listeners} listeners, which is the limit`)
    const id = this.exchange.functionOf(wire, 'the listener') && wire.id
    const listener = (...values) => {
      if (once) this.unlisten(event, wire)
      this.hear(event, id, values)
    }
    this.listeners.push({ event, id, listener })
    this.bot.on(event, listener)
    return null
  }

  // Catch errors here: they must not reach the emitter of the event.
  hear (event, id, values) {
    const [ok, wires] = this.converted(true, () => events[event].map((type, i) => this.eventValue(type, values[i], event)), `bot.on ${event}`)
    if (ok) this.wake(['invoke', id, wires, NOBODY])
    else this.finish({ ok: false, error: wires })
  }

  eventValue (type, value, event) {
    return value === undefined || value === null ? this.exchange.toGuest(value, event) : type.toGuest(this.exchange, value, event)
  }

  unlisten (event, wire) {
    const index = this.listeners.findIndex((entry) => entry.event === event && entry.id === wire?.id)
    if (index < 0) return null
    const [{ listener }] = this.listeners.splice(index, 1)
    this.bot.removeListener(event, listener)
    return null
  }

  startTimer (id, wire, repeat) {
    if (!Number.isSafeInteger(id)) throw new RefusedError(`the number of a timer must be a whole number, found ${describeWire(id)}`)
    if (this.timers.has(id)) throw new RefusedError(`there is a timer ${id} already`)
    if (this.timers.size >= LIMITS.timers) throw new RefusedError(`the program has ${LIMITS.timers} timers, which is the limit`)
    const delay = Math.min(Math.max(this.exchange.number(wire, 'the delay of a timer'), 0), 2 ** 31 - 1)
    const fire = () => {
      if (!repeat) this.timers.delete(id)
      this.wake(['fire', id])
    }
    const timer = repeat ? setInterval(fire, delay) : setTimeout(fire, delay)
    const what = repeat ? 'setInterval' : 'setTimeout'
    this.timers.set(id, { what, statement: this.guest.lastStatement, stop: () => repeat ? clearInterval(timer) : clearTimeout(timer) })
    return null
  }

  stopTimer (id) {
    this.timers.get(id)?.stop()
    this.timers.delete(id)
    return null
  }

  write (level, text) {
    if (this.log.length >= LIMITS.logLines || this.logRoom <= 0) return null
    const written = cut(typeof text === 'string' ? text : describeWire(text), this.logRoom)
    this.logRoom -= written.length
    const isLast = this.log.length === LIMITS.logLines - 1 || this.logRoom <= 0
    this.log.push({ level: cut(primitive(level), LIMITS.level), text: isLast ? `${written} ... (the rest of the output is left out)` : written })
    return null
  }

  table (name) {
    if (this.data === null || !Object.hasOwn(tables, name)) throw new RefusedError('mcData has no such table')
    return this.data[name] ?? {}
  }

  entry (name, key) {
    const table = this.table(name)
    const value = key === null ? table : Object.hasOwn(table, key) ? table[key] : undefined
    return plainToGuest(value)
  }

  blockState (id) {
    return plainToGuest(stateOf(this.exchange.blockOfState(id)))
  }
}

const HANDLERS = {
  get: (session, handle, name) => session.get(handle, name),
  set: (session, handle, name, wire) => session.set(handle, name, wire),
  call: (session, handle, name, wires) => session.call(handle, name, wires),
  skill: (session, name, wires) => session.callSkill(name, wires),
  on: (session, event, wire, once) => session.listen(event, wire, once),
  off: (session, event, wire) => session.unlisten(event, wire),
  timer: (session, id, delay, repeat) => session.startTimer(id, delay, repeat === true),
  untimer: (session, id) => session.stopTimer(id),
  log: (session, level, text) => session.write(level, text),
  data: (session, name, key) => session.entry(name, key),
  keys: (session, name) => Object.keys(session.table(name)),
  state: (session, id) => session.blockState(id),
  settled: (session, ticket, ok, wire) => session.settled(ticket, ok, wire)
}

// Do not convert other values to text: that would take time, or reveal what the policy does not allow.
function primitive (value) {
  return (typeof value === 'object' && value !== null) || typeof value === 'function' ? 'something that is no text' : String(value)
}

// mcData contains only data; values that JSON cannot express are left out.
function plainToGuest (value) {
  if (value === undefined) return { $: 'u' }
  if (value === null || typeof value !== 'object') return typeof value === 'function' ? { $: 'u' } : value
  if (Array.isArray(value)) return value.map(plainToGuest)
  return { $: 'o', o: Object.entries(value).filter(([, item]) => typeof item !== 'function').map(([key, item]) => [key, plainToGuest(item)]) }
}

// Return the pathfinder's own name of an error; a failed skill that walked has the pathfinder's error as its cause.
function reasonOf (error) {
  return [error, error?.cause].some(each => each instanceof Error && each.name === 'NoPath') ? 'no_way' : null
}

function missing (index, wires) {
  return index in wires ? wires[index] : { $: 'u' }
}

function trimmed (args) {
  const last = args.findLastIndex((arg) => arg !== undefined)
  return args.slice(0, last + 1)
}

function isThenable (value) {
  return value !== null && typeof value === 'object' && typeof value.then === 'function'
}

/** Error of a call, with the name of the skill or method that was called. */
class CallError extends Error {
  constructor (label, cause) {
    super(`${label} failed`, { cause })
    this.label = label
  }
}

module.exports = { LIMITS, REQUEST_COST, Session }
