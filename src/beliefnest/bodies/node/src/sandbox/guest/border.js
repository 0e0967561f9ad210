'use strict'
/**
 * The guest's side of the border: values to and from JSON, calls to the host, promises, functions.
 * The host trusts nothing that is computed here.
 * Runs inside QuickJS: the function is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineBorder (env) {
  const { stringify, parse } = JSON
  const handles = new Map()
  const handleOf = new WeakMap()
  const functions = new Map()
  const functionIds = new WeakMap()
  const promises = new Map()
  const errorNotes = new WeakMap()
  const states = new Map()
  let nextFunction = 1

  function special (number) {
    return Object.is(number, -0) ? '-0' : String(number)
  }

  function encodeNumber (value) {
    return Number.isFinite(value) && !Object.is(value, -0) ? value : { $: 'n', v: special(value) }
  }

  function encodeFunction (value) {
    if (!functionIds.has(value)) {
      functionIds.set(value, nextFunction)
      functions.set(nextFunction++, value)
    }
    return { $: 'f', id: functionIds.get(value) }
  }

  function encodeObject (value, depth) {
    if (depth > 32) throw new TypeError('a value handed out of the program is nested more than 32 deep')
    if (env.isVector(value)) return { $: 'v', c: [value.x, value.y, value.z].map((c) => encodeNumber(Number(c))) }
    if (handleOf.has(value)) return handle(value)
    const note = env.noteOf(value)
    if (note) return note.a ? { ...note, a: note.a.map((item) => encode(item, depth + 1)) } : note
    if (value instanceof env.Movements) return { $: 'm', o: entries(value, depth) }
    if (value instanceof Error) return { $: 'e', message: String(value.message), name: String(value.name) }
    if (value instanceof Promise) throw new TypeError('a promise was handed out of the program: an await is missing')
    if (Array.isArray(value)) return value.map((item) => encode(item, depth + 1))
    return { $: 'o', o: entries(value, depth) }
  }

  function handle (object) {
    if (!handleOf.has(object)) throw new TypeError('the value is no object of the game')
    return { $: 'h', id: handleOf.get(object) }
  }

  function entries (value, depth) {
    return Object.keys(value).map((key) => [key, encode(value[key], depth + 1)])
  }

  function encode (value, depth = 0) {
    switch (typeof value) {
      case 'string': case 'boolean': return value
      case 'number': return encodeNumber(value)
      case 'undefined': return { $: 'u' }
      case 'function': return encodeFunction(value)
      case 'object': return value === null ? null : encodeObject(value, depth)
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
    if (!states.has(id)) states.set(id, env.deepFreeze(request(['state', id])))
    return states.get(id)
  }

  function decodeError ({ message, name, skill, kind, stack }) {
    const error = new Error(message)
    if (name !== 'Error') Object.defineProperty(error, 'name', { value: name, configurable: true, writable: true })
    errorNotes.set(error, { skill, kind, stack })
    return error
  }

  const decoders = {
    u: () => undefined,
    n: ({ v }) => Number(v),
    v: ({ c }) => env.vector(decode(c[0]), decode(c[1]), decode(c[2])),
    h: decodeHandle,
    b: ({ s, c, l }) => env.makeBlock(blockState(s), c[0], c[1], c[2], l[0], l[1]),
    i: ({ d }) => env.makeItem(decode(d)),
    e: decodeError,
    p: ({ id }) => new Promise((resolve, reject) => promises.set(id, { resolve, reject })),
    o: ({ o }) => Object.fromEntries(o.map(([key, value]) => [key, decode(value)]))
  }

  function decode (wire) {
    if (wire === null || typeof wire !== 'object') return wire
    return Array.isArray(wire) ? wire.map(decode) : decoders[wire.$](wire)
  }

  function request (message) {
    const { ok, value } = parse(env.host(stringify(message)))
    if (!ok) throw decodeError(value)
    return decode(value)
  }

  // The error of an awaited call is made when the answer arrives; its place is where the call was made.
  function call (message) {
    const result = request(message)
    if (!(result instanceof Promise)) return result
    const place = new Error('').stack
    return result.catch((error) => {
      const note = errorNotes.get(error)
      if (note) note.stack ??= place
      throw error
    })
  }

  function describe (error) {
    if (!(error instanceof Error)) return { thrown: true, message: env.show(error), name: typeof error }
    const note = errorNotes.get(error) ?? {}
    return {
      message: String(error.message), name: String(error.name), stack: String(note.stack ?? error.stack ?? ''),
      skill: note.skill ?? null, kind: note.kind ?? null
    }
  }

  function settle (id, ok, value) {
    const { resolve, reject } = promises.get(id)
    promises.delete(id)
    if (ok) resolve(decode(value))
    else reject(decode(value))
  }

  // A function of the program that answers with a promise answers the host later, by `settled`.
  function invoke (id, args, ticket) {
    return answer(functions.get(id)(...args.map(decode)), ticket)
  }

  function answer (result, ticket) {
    if (!(result instanceof Promise)) return { now: encode(result) }
    result.then((value) => request(['settled', ticket, true, encode(value)]))
      .catch((error) => { request(['settled', ticket, false, describe(error)]) })
    return { later: true }
  }

  Object.assign(env, { handle, isHandle: (value) => handleOf.has(value), encode, decode, request, call, describe, settle, invoke, answer })
}
