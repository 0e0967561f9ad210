'use strict'
/**
 * Memory of a program's calls, with which an interrupted program can continue. Its text runs again from the beginning,
 * and each call that had finished returns its recorded result without being executed again (design/channel.md).
 */
const { SkillError } = require('../../../../skills/code')

const MOST = 2000
const DEEPEST = 6
const WIDEST = 100
const NO_WAY = 'NoPath'
const DONE = JSON.stringify({ ok: true, value: null })
/** Place of the number of ticks among the arguments of waits, and the number that counts if there is none. */
const WAITS = new Map([['waitTicks', { at: 0 }], ['bot.waitForTicks', { at: 0 }], ['waitUntil', { at: 1, usual: 200 }], ['waitForChat', { at: 0, usual: 100 }]])

class Memory {
  /**
   * @param {object[]} past CALLED, in order
   * @param {() => number} now returns the current tick
   * @param {AbortSignal} signal aborted when the program has ended
   */
  constructor (past, now, signal) {
    Object.assign(this, { past: [...past], now, signal, entries: [] })
  }

  /**
   * Record a call. The entry's `answer` is the result from before the interruption, or null if the call had not
   * finished.
   */
  note (name, args) {
    const argumentText = JSON.stringify(plain(args))
    let past = this.past.shift() ?? null
    if (past !== null && (past.name !== name || past.given !== argumentText)) {
      // From here on the program takes another course.
      this.past = []
      past = null
    }
    const entry = { name, 'given': argumentText, answer: past?.answer ?? null, before: past?.ticks ?? 0, begun: this.now(), since: past?.since ?? this.now() }
    this.entries.push(entry)
    return entry
  }

  /** Execute a skill, or return its recorded result. */
  async call (name, args, act) {
    const entry = this.note(name, args)
    if (entry.answer !== null) return recalled(name, JSON.parse(entry.answer))
    try {
      const value = await act(...this.left(entry, args))
      this.answered(entry, { ok: true, value: plain(value) })
      return value
    } catch (error) {
      const noWay = [error, error?.cause].some(each => each?.name === NO_WAY)
      this.answered(entry, { ok: false, value: { message: String(error?.message), noWay } })
      throw error
    }
  }

  /** Say something, unless it was said before the interruption. */
  say (name, words, speak) {
    const entry = this.note(name, words)
    if (entry.answer !== null) return undefined
    const said = speak(...words)
    if (said instanceof Promise) return said.then(() => this.answered(entry, DONE))
    this.answered(entry, DONE)
    return said
  }

  /** Return the arguments for a call that was interrupted: a wait continues with the ticks that are left. */
  left ({ name, before }, args) {
    if (!WAITS.has(name) || before === 0) return args
    const { at, usual } = WAITS.get(name)
    const ticks = args[at] ?? usual
    return Number.isInteger(ticks) ? args.toSpliced(at, 1, Math.max(1, ticks - before)) : args
  }

  // Ignore calls that end after the program was ended.
  answered (entry, answer) {
    if (!this.signal.aborted) entry.answer = typeof answer === 'string' ? answer : JSON.stringify(answer)
  }

  /** Return CALLED, in order; empty if there are too many calls to continue from. @returns {object[]} */
  get calls () {
    if (this.entries.length > MOST) return []
    return this.entries.map(({ name, given: argumentText, answer, before, begun, since }) =>
      ({ name, 'given': argumentText, answer, ticks: answer === null ? before + this.now() - begun : 0, since }))
  }
}

function recalled (name, { ok, value }) {
  if (ok) return value ?? undefined
  const cause = value.noWay ? Object.assign(new Error(value.message), { name: NO_WAY }) : undefined
  throw new SkillError(name, value.message, cause)
}

/** Return a value as plain data; other values are replaced by the name of their type. */
function plain (value, depth = 0) {
  if (value === null || value === undefined) return null
  if (typeof value !== 'object') return typeof value === 'function' || typeof value === 'bigint' ? String(value).slice(0, 1000) : value
  if (depth > DEEPEST) return 'deep'
  if (Array.isArray(value)) return value.slice(0, WIDEST).map(each => plain(each, depth + 1))
  if (typeof value.x === 'number' && typeof value.z === 'number') return [value.x, value.y, value.z]
  const proto = Object.getPrototypeOf(value)
  if (proto !== Object.prototype && proto !== null) return 'an object of the game'
  return Object.fromEntries(Object.entries(value).slice(0, WIDEST).map(([key, each]) => [key, plain(each, depth + 1)]))
}

module.exports = { Memory }
