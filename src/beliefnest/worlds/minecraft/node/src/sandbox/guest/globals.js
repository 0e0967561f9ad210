'use strict'
/**
 * Globals of a program besides the language: time, random numbers, timers, console, mcData, the classes behind
 * handles, the skills.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineGlobals (env) {
  const { apply, ask, call, config, encode, encodeList, handle, own, quote, toNumber, toText } = env
  const { max } = Math
  const timers = own(new Map())
  let nextTimer = 1

  function show (value, depth = 0) {
    if (typeof value === 'string') return depth ? quote(value) : value
    if (typeof value === 'function') return `[function ${value.name}]`
    if (value instanceof Error) return `${value.name}: ${value.message}`
    if (env.isVector(value) || value === null || typeof value !== 'object') return toText(value)
    if (env.isHandle(value)) return `[${env.kindOf(value)}]`
    if (depth > 3) return Array.isArray(value) ? '[...]' : '{...}'
    if (Array.isArray(value)) return `[${value.map((item) => show(item, depth + 1)).join(', ')}]`
    return `{${Object.keys(value).map((key) => `${key}: ${show(value[key], depth + 1)}`).join(', ')}}`
  }

  function deepFreeze (value) {
    if (value !== null && typeof value === 'object') Object.values(Object.freeze(value)).forEach(deepFreeze)
    return value
  }

  function startTimer (callback, delay, args, repeat) {
    if (typeof callback !== 'function') throw new TypeError('the first argument of a timer must be a function')
    const id = nextTimer++
    ask('timer', encode(id), encode(max(toNumber(delay) || 0, repeat ? 1 : 0)), encode(repeat))
    timers.set(id, { callback, args, repeat })
    return id
  }

  function stopTimer (id) {
    if (timers.delete(id)) ask('untimer', encode(id))
  }

  function fire (id) {
    const { callback, args, repeat } = timers.get(id)
    if (!repeat) timers.delete(id)
    const result = apply(callback, undefined, args)
    if (result instanceof Promise) env.answer(result, 0)
  }

  function readOnly (what) {
    return () => { throw new TypeError(`${what} is read-only`) }
  }

  function lazyTable (name) {
    const values = own(new Map())
    let keys
    const get = (key) => {
      if (!values.has(key)) values.set(key, deepFreeze(ask('data', quote(name), quote(key))))
      return values.get(key)
    }
    const allKeys = () => (keys ??= ask('keys', quote(name)))
    const refuse = readOnly(`mcData.${name}`)
    return new Proxy({}, {
      get: (_, key) => typeof key === 'string' ? get(key) : undefined,
      has: (_, key) => typeof key === 'string' && get(key) !== undefined,
      ownKeys: () => allKeys(),
      getOwnPropertyDescriptor: (_, key) => get(key) === undefined
        ? undefined
        : { value: get(key), enumerable: true, configurable: true, writable: false },
      set: refuse,
      defineProperty: refuse,
      deleteProperty: refuse
    })
  }

  function defineData () {
    const data = {}
    for (const [name, form] of Object.entries(config.tables)) {
      let value = form === 'table' ? lazyTable(name) : undefined
      const get = () => (value ??= deepFreeze(ask('data', quote(name), 'null')))
      Object.defineProperty(data, name, { get, enumerable: true })
    }
    return Object.freeze(data)
  }

  function defineKind (name, { gets, sets, calls }) {
    const prototype = env.kinds[name]
    for (const property of gets) {
      const quoted = quote(property)
      const set = sets.includes(property)
        ? function (value) { ask('set', handle(this), quoted, encode(value)) }
        : readOnly(`${name}.${property}`)
      const get = function () { return ask('get', handle(this), quoted) }
      Object.defineProperty(prototype, property, { get, set, configurable: true })
    }
    for (const method of calls) {
      const quoted = quote(method)
      prototype[method] = function (...args) {
        return call('call', handle(this), quoted, encodeList(args))
      }
    }
  }

  function defineKinds () {
    for (const [name, kind] of Object.entries(config.kinds)) defineKind(name, kind)
    const bot = env.kinds.bot
    for (const alias of ['off', 'removeListener']) bot[alias] = removeListener
    bot.on = bot.addListener = function (event, listener) { return addListener(this, event, listener, false) }
    bot.once = function (event, listener) { return addListener(this, event, listener, true) }
  }

  function addListener (bot, event, listener, once) {
    if (typeof listener !== 'function') throw new TypeError('the second argument of bot.on must be a function')
    ask('on', quote(event), encode(listener), encode(once))
    return bot
  }

  function removeListener (event, listener) {
    if (typeof listener === 'function') ask('off', quote(event), encode(listener))
    return this
  }

  function defineConsole () {
    const logger = (level) => (...values) => {
      let text = ''
      for (let i = 0; i < values.length; i++) text += (i > 0 ? ' ' : '') + toText(show(values[i]))
      ask('log', quote(level), quote(text))
    }
    globalThis.console = Object.fromEntries(['log', 'info', 'debug', 'warn', 'error'].map((level) => [level, logger(level)]))
  }

  Object.assign(env, { show, deepFreeze, fire })
  env.kindOf = (value) => Object.keys(env.kinds).find((kind) => Object.getPrototypeOf(value) === env.kinds[kind])
  env.kinds = Object.fromEntries(Object.keys(config.kinds).map((name) => [name, {}]))
  defineKinds()
  defineConsole()
  Math.random = () => env.random()
  globalThis.setTimeout = (callback, delay, ...args) => startTimer(callback, delay, args, false)
  globalThis.setInterval = (callback, delay, ...args) => startTimer(callback, delay, args, true)
  globalThis.setImmediate = (callback, ...args) => startTimer(callback, 0, args, false)
  globalThis.clearTimeout = globalThis.clearInterval = globalThis.clearImmediate = stopTimer
  globalThis.queueMicrotask = (callback) => { Promise.resolve().then(callback) }
  env.bindSkills = (names) => Object.fromEntries(names.map((name) =>
    [name, (...args) => call('skill', quote(name), encodeList(args))]))
  env.bindData = () => {
    const data = defineData()
    Object.defineProperty(env.kinds.bot, 'registry', { value: data })
    return data
  }
}
