'use strict'
/**
 * Types of the policy. A type converts values at the border in one or both directions: `toHost(exchange, wire, where)`
 * checks a value of the program, `toGuest(exchange, value, where)` copies a value for the program or names it by a
 * handle. `async` types wait for a promise of the host.
 */

const { RefusedError, describeWire, isTagged, itemToGuest, vectorToGuest } = require('../exchange')
const { buildGoal, buildMovements } = require('../constructions')
const { LONGEST, LONGEST_WHISPER, flawOf, signFlawOf } = require('../../../../../../skills/code/lib/text')

const MAX_DISTANCE = 128
const MAX_BLOCKS = 10_000
const MAX_TICKS = 1_000_000
const LONGEST_WORDS = 1000
const LEGAL_NAME = /^\w{1,16}$/

const plain = { toHost: (x, wire, where) => x.toHost(wire, where), toGuest: (x, value, where) => x.toGuest(value, where) }
const nothing = { toGuest: () => ({ $: 'u' }) }
const boolean = {
  toHost: (x, wire, where) => {
    if (typeof wire !== 'boolean') throw new RefusedError(`${where} must be true or false, found ${describeWire(wire)}`)
    return wire
  },
  toGuest: (x, value) => Boolean(value)
}
const number = {
  toHost: (x, wire, where) => x.number(wire, where),
  toGuest: (x, value, where) => x.toGuest(value, where)
}
const text = { toHost: (x, wire, where) => x.text(wire, where), toGuest: (x, value) => String(value) }
/** Text of a server's message, as a client shows it. */
const words = { toGuest: (x, value) => messageText(x.bot.registry, value) }
const vector = { toHost: (x, wire, where) => x.vector(wire, where), toGuest: (x, value) => vectorToGuest(value) }
const block = { toHost: (x, wire, where) => x.block(wire, where), toGuest: (x, value) => x.blockToGuest(value) }
const item = { toHost: (x, wire, where) => x.item(wire, where), toGuest: (x, value) => itemToGuest(value) }
const goal = { toHost: buildGoal }
const movements = { toHost: buildMovements }

/** Return the type of numbers between two bounds, inclusive. */
const within = (low, high) => ({
  toHost: (x, wire, where) => {
    const value = x.number(wire, where)
    if (value < low || value > high) throw new RefusedError(`${where} must be between ${low} and ${high}, found ${value}`)
    return value
  },
  toGuest: number.toGuest
})

/** Return the type of whole numbers between two bounds, inclusive. */
const whole = (low, high) => ({
  toHost: (x, wire, where) => {
    const value = within(low, high).toHost(x, wire, where)
    if (!Number.isInteger(value)) throw new RefusedError(`${where} must be a whole number, found ${value}`)
    return value
  },
  toGuest: number.toGuest
})
const count = whole(0, 1_000_000)
const ticks = { toHost: (x, wire, where) => Math.ceil(within(0, MAX_TICKS).toHost(x, wire, where)) }
const slot = within(-1, 1000)

/** Return the type of one of several texts. */
const choice = (...values) => ({
  toHost: (x, wire, where) => {
    if (!values.includes(wire)) throw new RefusedError(`${where} must be one of ${values.join(', ')}, found ${describeWire(wire)}`)
    return wire
  },
  toGuest: text.toGuest
})

/** Return the type of live game objects of one of some kinds. */
const live = (...kinds) => ({
  toHost: (x, wire, where) => x.object(wire, kinds, where),
  toGuest: (x, value) => x.handle(value, kinds[0])
})

const isAbsent = (wire) => wire === undefined || wire === null || isTagged(wire, 'u')

/** Return the type that also accepts nothing; null and undefined stay what they are. */
const maybe = (type) => ({
  toHost: (x, wire, where) => isAbsent(wire) ? (wire === null ? null : undefined) : type.toHost(x, wire, where),
  toGuest: (x, value, where) => value === undefined ? { $: 'u' } : value === null ? null : type.toGuest(x, value, where)
})

const list = (type) => ({
  toHost: (x, wire, where) => {
    if (!Array.isArray(wire) || wire.length > MAX_BLOCKS) throw new RefusedError(`${where} must be an array of at most ${MAX_BLOCKS} elements`)
    return wire.map((element, i) => type.toHost(x, element, `${where}[${i}]`))
  },
  toGuest: (x, values, where) => Array.from(values, (value, i) => type.toGuest(x, value, `${where}[${i}]`))
})

/** Return the type of objects with any keys and values of one type. */
const dictionary = (type) => ({
  toGuest: (x, values, where) => ({ $: 'o', o: Object.entries(values).map(([key, value]) => [key, type.toGuest(x, value, `${where}.${key}`)]) })
})

/** Return the type of a copy of the named properties. */
const record = (fields) => ({
  toGuest: (x, value, where) => ({
    $: 'o',
    o: Object.entries(fields).filter(([key]) => value[key] !== undefined)
      .map(([key, type]) => [key, type.toGuest(x, value[key], `${where}.${key}`)])
  })
})

/** Return the first of some types that accepts the value. */
const either = (...types) => ({
  toHost: (x, wire, where) => {
    const reasons = []
    for (const type of types) {
      try {
        return type.toHost(x, wire, where)
      } catch (error) {
        if (!(error instanceof RefusedError)) throw error
        reasons.push(error.message)
      }
    }
    throw new RefusedError(reasons.join('; or '))
  }
})

const later = (type) => ({ async: true, toGuest: type.toGuest })

/** Return the type of texts that an agent can say, up to a number of characters. */
const speech = (longest) => ({
  toHost: (x, wire, where) => {
    const message = typeof wire === 'number' ? String(x.number(wire, where)) : x.text(wire, where)
    const flaw = flawOf(message, longest)
    if (flaw !== null) throw new RefusedError(`${where} ${flaw}`)
    if (message.trimStart().startsWith('/')) throw new RefusedError(`${where} is a command; an agent can only speak`)
    return message
  }
})
const chatText = speech(LONGEST)
const whisperText = speech(LONGEST_WHISPER)

const signText = {
  toHost: (x, wire, where) => {
    const written = x.text(wire, where)
    const flaw = signFlawOf(written)
    if (flaw !== null) throw new RefusedError(`${where} ${flaw}`)
    return written
  }
}

const playerName = {
  toHost: (x, wire, where) => {
    const name = x.text(wire, where)
    if (!LEGAL_NAME.test(name)) throw new RefusedError(`${where} must be the name of an agent, found ${describeWire(wire)}`)
    return name
  }
}

// A program's matcher gets a block without a position unless `useExtraInfo` is set, so that its answers can be cached
// per block state.
const matcher = {
  toHost: (x, wire, where) => {
    const matches = x.functionOf(wire, where)
    const verdicts = new Map()
    return (candidate) => {
      if (candidate.position) return Boolean(matches(candidate))
      if (!verdicts.has(candidate.stateId)) verdicts.set(candidate.stateId, Boolean(matches({ ...stateOf(candidate) })))
      return verdicts.get(candidate.stateId)
    }
  }
}

const STATE_FIELDS = {
  stateId: number, type: number, name: text, displayName: text, metadata: number, hardness: maybe(number),
  diggable: boolean, boundingBox: text, transparent: boolean, material: text, harvestTools: plain,
  shapes: plain, isWaterlogged: boolean
}

/** Return the properties that all blocks of a state share, as plain data. @returns {object} */
function stateOf (candidate) {
  const fields = Object.keys(STATE_FIELDS).filter((key) => candidate[key] !== undefined && candidate[key] !== null)
  const state = Object.fromEntries(fields.map((key) => [key, candidate[key]]))
  return { ...state, _properties: { ...candidate.getProperties() } }
}

const entityFilter = {
  toHost: (x, wire, where) => {
    const matches = x.functionOf(wire, where)
    return (entity) => Boolean(matches(entity))
  }
}

// Convert a list of ids to a set lookup; Mineflayer would search the list for every block.
const oneOf = {
  toHost: (x, wire, where) => {
    const wanted = new Set(list(count).toHost(x, wire, where))
    return (block) => wanted.has(block.type)
  }
}

const search = {
  toHost: (x, wire, where) => {
    const written = new Map(isTagged(wire, 'o') ? wire.o : [])
    const read = (key, type, otherwise) => isAbsent(written.get(key)) ? otherwise : type.toHost(x, written.get(key), `${where}.${key}`)
    if (!written.has('matching')) throw new RefusedError(`${where} must be an object with the key matching`)
    return {
      matching: either(matcher, count, oneOf).toHost(x, written.get('matching'), `${where}.matching`),
      maxDistance: read('maxDistance', within(0, MAX_DISTANCE), 16),
      count: read('count', within(1, MAX_BLOCKS), 1),
      point: read('point', vector, undefined),
      useExtraInfo: read('useExtraInfo', boolean, false)
    }
  }
}

function messageText (registry, message) {
  if (message === undefined || message === null) return ''
  const ChatMessage = require('prismarine-chat')(registry)
  return ChatMessage.fromNotch(message).toString().slice(0, LONGEST_WORDS)
}

module.exports = {
  plain, nothing, boolean, number, text, words, vector, block, item, goal, movements, within, whole, count, ticks, slot, choice,
  live, maybe, list, dictionary, record, either, later, chatText, whisperText, signText, playerName, entityFilter, search, stateOf
}
