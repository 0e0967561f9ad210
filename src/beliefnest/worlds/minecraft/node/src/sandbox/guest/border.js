'use strict'
/**
 * Guest's side of the border: conversion of values to and from JSON, calls to the host, promises, functions. The host
 * trusts nothing that is computed here.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineBorder (env) {
  const { apply, each, is, isArray, isFinite, keys, own, parse, quote, quoteSome, toNumber } = env
  const handles = own(new Map())
  const handleOf = own(new WeakMap())
  const functions = own(new Map())
  const functionIds = own(new WeakMap())
  const promises = own(new Map())
  const errorNotes = own(new WeakMap())
  const states = own(new Map())
  const { fromEntries } = Object
  let nextFunction = 1

  // Functions called encode... return JSON.
  function encodeNumber (value) {
    if (isFinite(value) && !is(value, -0)) return '' + value
    return '{"$":"n","v":"' + (is(value, -0) ? '-0' : value) + '"}'
  }

  function encodeFunction (value) {
    if (!functionIds.has(value)) {
      functionIds.set(value, nextFunction)
      functions.set(nextFunction++, value)
    }
    return '{"$":"f","id":' + functionIds.get(value) + '}'
  }

  function encodeObject (value, depth) {
    if (depth > 32) throw new TypeError('a value handed out of the program is nested more than 32 deep')
    if (env.isVector(value)) return encodeVector(value)
    if (handleOf.has(value)) return handle(value)
    const note = env.noteOf(value)
    if (note) return encodeNote(note, depth)
    if (value instanceof env.Movements) return encodeEntries('m', value, depth)
    if (value instanceof Error) return '{"$":"e","message":' + quote(value.message) + ',"name":' + quote(value.name) + '}'
    if (value instanceof Promise) throw new TypeError('a promise was handed out of the program: an await is missing')
    if (isArray(value)) return encodeList(value, depth)
    return encodeEntries('o', value, depth)
  }

  function encodeVector ({ x, y, z }) {
    return '{"$":"v","c":[' + encodeNumber(toNumber(x)) + ',' + encodeNumber(toNumber(y)) + ',' + encodeNumber(toNumber(z)) + ']}'
  }

  function encodeNote (note, depth) {
    switch (note.$) {
      case 'g': return '{"$":"g","n":' + quote(note.n) + ',"a":' + encodeList(note.a, depth) + '}'
      case 'b': return '{"$":"b","c":' + encodeList(note.c, depth) + '}'
      default: return '{"$":"i","slot":' + encode(note.slot, depth + 1) + ',"type":' + encode(note.type, depth + 1) + '}'
    }
  }

  function handle (object) {
    if (!handleOf.has(object)) throw new TypeError('the value is no object of the game')
    return '{"$":"h","id":' + encodeNumber(toNumber(handleOf.get(object))) + '}'
  }

  function encodeList (list, depth = 0) {
    let text = '['
    for (let i = 0; i < list.length; i++) text += (i > 0 ? ',' : '') + encode(list[i], depth + 1)
    return text + ']'
  }

  function encodeEntries (tag, value, depth) {
    const names = keys(value)
    let text = '{"$":"' + tag + '","o":['
    for (let i = 0; i < names.length; i++) text += (i > 0 ? ',[' : '[') + quote(names[i]) + ',' + encode(value[names[i]], depth + 1) + ']'
    return text + ']}'
  }

  function encode (value, depth = 0) {
    switch (typeof value) {
      case 'string': return quote(value)
      case 'boolean': return value ? 'true' : 'false'
      case 'number': return encodeNumber(value)
      case 'undefined': return '{"$":"u"}'
      case 'function': return encodeFunction(value)
      case 'object': return value === null ? 'null' : encodeObject(value, depth)
      default: throw new TypeError(`a ${typeof value} cannot be handed out of the program`)
    }
  }

  function decodeHandle ({ id, k }) {
    if (!handles.has(id)) {
      const object = Object.create(env.kinds[k])
      handles.set(id, object)
      handleOf.set(object, id)
    }
    return handles.get(id)
  }

  function blockState (id) {
    if (!states.has(id)) states.set(id, env.deepFreeze(ask('state', encodeNumber(toNumber(id)))))
    return states.get(id)
  }

  function decodeError ({ message, name, skill, kind, reason, stack }) {
    const error = new Error(message)
    if (name !== 'Error') Object.defineProperty(error, 'name', { value: name, configurable: true, writable: true })
    errorNotes.set(error, { skill, kind, reason, stack })
    return error
  }

  const decoders = {
    u: () => undefined,
    n: ({ v }) => Number(v),
    v: ({ c }) => env.vector(decode(c[0]), decode(c[1]), decode(c[2])),
    h: decodeHandle,
    b: ({ s, c, l, t }) => env.makeBlock(blockState(s), c[0], c[1], c[2], l[0], l[1], t),
    i: ({ d }) => env.makeItem(decode(d)),
    e: decodeError,
    p: ({ id }) => new Promise((resolve, reject) => promises.set(id, { resolve, reject })),
    o: ({ o }) => fromEntries(each(o, (entry) => [entry[0], decode(entry[1])]))
  }

  function decode (wire) {
    if (wire === null || typeof wire !== 'object') return wire
    return Array.isArray(wire) ? each(wire, decode) : decoders[wire.$](wire)
  }

  /** Send a request to the host; the parts after the action are JSON. */
  function ask (action, ...parts) {
    let text = '["' + action + '"'
    for (let i = 0; i < parts.length; i++) text += ',' + parts[i]
    const answer = parse(env.host(text + ']'))
    if (!answer.ok) throw decodeError(answer.value)
    return decode(answer.value)
  }

  // The error of an awaited call is created when the answer arrives; give it the stack of the call.
  function call (action, subject, first, second) {
    const result = second === undefined ? ask(action, subject, first) : ask(action, subject, first, second)
    if (!(result instanceof Promise)) return result
    const place = new Error('').stack
    return result.catch((error) => {
      const note = errorNotes.get(error)
      if (note) note.stack ??= place
      throw error
    })
  }

  /** Return JSON of an error's description for the host. @returns {string} */
  function describe (error) {
    if (!(error instanceof Error)) return '{"thrown":true,"message":' + quoteSome(env.show(error)) + ',"name":"' + typeof error + '"}'
    const note = errorNotes.get(error)
    const stack = note?.stack ?? error.stack ?? ''
    return '{"message":' + quoteSome(error.message) + ',"name":' + quoteSome(error.name) + ',"stack":' + quoteSome(stack) +
      (note ? ',"skill":' + encode(note.skill) + ',"kind":' + encode(note.kind) + ',"reason":' + encode(note.reason) : '') + '}'
  }

  function settle (id, ok, value) {
    const { resolve, reject } = promises.get(id)
    promises.delete(id)
    if (ok) resolve(decode(value))
    else reject(decode(value))
  }

  // Call a function of the program for the host. If it returns a promise, the host gets the result later, by
  // `settled`.
  function invoke (id, args, ticket) {
    return answer(apply(functions.get(id), undefined, each(args, decode)), ticket)
  }

  /** Return the result of a call as JSON. @returns {string} */
  function answer (result, ticket) {
    if (!(result instanceof Promise)) return '{"now":' + encode(result) + '}'
    result.then((value) => ask('settled', encode(ticket), 'true', encode(value)))
      .catch((error) => { ask('settled', encode(ticket), 'false', describe(error)) })
    return '{"later":true}'
  }

  Object.assign(env, { ask, handle, isHandle: (value) => handleOf.has(value), encode, encodeList, decode, call, describe, settle, invoke, answer })
}
