'use strict'
/**
 * Replacement of every source of time and chance in this process by the clock's. It must be installed before any other
 * module is loaded, because modules keep the functions that they find when they load.
 */
const crypto = require('node:crypto')
const perfHooks = require('node:perf_hooks')
const timers = require('node:timers')
const timersPromises = require('node:timers/promises')
const util = require('node:util')

const RealDate = Date
const realNow = perfHooks.performance.now.bind(perfHooks.performance)

/**
 * Install the clock's time and random numbers.
 * @param {import('./clock').Clock} clock
 */
function installTime (clock) {
  installDate(clock)
  installTimers(clock)
  installCounters(clock)
  installRandom(clock)
}

function installDate (clock) {
  function VirtualDate (...args) {
    if (!new.target) return new RealDate(clock.epochNow()).toString()
    return Reflect.construct(RealDate, args.length === 0 ? [clock.epochNow()] : args, new.target)
  }
  VirtualDate.prototype = RealDate.prototype
  VirtualDate.prototype.constructor = VirtualDate
  VirtualDate.now = () => clock.epochNow()
  VirtualDate.UTC = RealDate.UTC
  VirtualDate.parse = RealDate.parse
  globalThis.Date = VirtualDate
}

function installTimers (clock) {
  const add = (callback, args, delay, repeat) => {
    if (typeof callback !== 'function') throw new TypeError('a timer needs a function to call')
    return clock.active.timers.add(callback, args, delay, repeat, clock.active.owner)
  }
  const clear = timer => { if (timer && typeof timer.close === 'function') timer.close() }
  const functions = {
    setTimeout: (callback, delay, ...args) => add(callback, args, milliseconds(delay), false),
    setInterval: (callback, delay, ...args) => add(callback, args, milliseconds(delay), true),
    setImmediate: (callback, ...args) => add(callback, args, 0, false),
    clearTimeout: clear,
    clearInterval: clear,
    clearImmediate: clear
  }
  const promised = {
    setTimeout: (delay, value) => new Promise(resolve => add(resolve, [value], milliseconds(delay), false)),
    setImmediate: value => new Promise(resolve => add(resolve, [value], 0, false))
  }
  functions.setTimeout[util.promisify.custom] = promised.setTimeout
  functions.setImmediate[util.promisify.custom] = promised.setImmediate
  Object.assign(globalThis, functions)
  Object.assign(timers, functions)
  Object.assign(timersPromises, promised)
}

// As in Node: at least one millisecond, also for anything that is not a number.
function milliseconds (delay) {
  const number = Number(delay)
  return number >= 1 ? number : 1
}

function installCounters (clock) {
  const now = () => clock.active.now()
  Object.defineProperty(perfHooks.performance, 'now', { value: now, configurable: true })
  const hrtime = previous => {
    const ms = now()
    const time = [Math.floor(ms / 1000), Math.round((ms % 1000) * 1e6)]
    if (previous === undefined) return time
    const nanoseconds = (time[0] - previous[0]) * 1e9 + time[1] - previous[1]
    return [Math.floor(nanoseconds / 1e9), nanoseconds % 1e9]
  }
  hrtime.bigint = () => BigInt(Math.round(now() * 1e6))
  process.hrtime = hrtime
  process.uptime = () => now() / 1000
}

function installRandom (clock) {
  const fill = bytes => clock.active.random.fill(bytes)
  Math.random = () => clock.active.random.next()
  crypto.randomBytes = (size, callback) => answer(fill(Buffer.alloc(size)), callback)
  crypto.randomFillSync = fill
  crypto.randomUUID = () => uuidFrom(fill(Buffer.alloc(16)))
  crypto.randomInt = (low, high) => high === undefined
    ? Math.floor(Math.random() * low)
    : low + Math.floor(Math.random() * (high - low))
}

function answer (value, callback) {
  if (callback === undefined) return value
  process.nextTick(callback, null, value)
  return undefined
}

function uuidFrom (bytes) {
  bytes[6] = (bytes[6] & 0x0f) | 0x40
  bytes[8] = (bytes[8] & 0x3f) | 0x80
  const hex = bytes.toString('hex')
  return [hex.slice(0, 8), hex.slice(8, 12), hex.slice(12, 16), hex.slice(16, 20), hex.slice(20)].join('-')
}

module.exports = { installTime, realNow }
