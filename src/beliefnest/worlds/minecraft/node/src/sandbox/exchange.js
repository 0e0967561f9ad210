'use strict'
/**
 * Host's side of the border. Values from the guest are checked and converted to host values; values for the guest are
 * copied or named by handles. This code trusts nothing of the guest.
 */

const { Vec3 } = require('vec3')
const { buildGoal, buildMovements } = require('./constructions')
const { cut } = require('./text')

const MAX_COORDINATE = 30_000_000
const MAX_TEXT = 100_000
const MAX_ELEMENTS = 10_000
const MAX_DEPTH = 32
const MAX_HANDLES = 20_000
const SHOWN = 40
// Fuel for looking up a block.
const BLOCK_COST = 1000
const FORBIDDEN_KEYS = new Set(['__proto__', 'constructor', 'prototype'])

/** Error for a value of the program that cannot be used. The message says which value and why. */
class RefusedError extends Error {
  constructor (message) {
    super(message)
    this.name = 'RefusedError'
  }
}

class Exchange {
  /**
   * @param {{bot: object, functionFor: function(number): function, kindOf: function(object): ?string, spend:
   *   function(number): boolean}} host `spend` charges fuel and returns whether the program continues
   */
  constructor ({ bot, functionFor, kindOf, spend }) {
    this.bot = bot
    this.functionFor = functionFor
    this.kindOf = kindOf
    this.spend = spend
    this.objects = []
    this.handles = new Map()
    this.states = new Map()
  }

  /** Charge fuel for host work that a value of the program causes. */
  pay (units) {
    if (!this.spend(units)) throw new RefusedError('the program has no fuel left for that')
  }

  /** Return the handle by which the guest names a host object. @returns {{$: 'h', id: number, k: string}} */
  handle (object, kind) {
    if (!this.handles.has(object)) {
      if (this.objects.length >= MAX_HANDLES) throw new RefusedError(`the program holds ${MAX_HANDLES} game objects, which is the limit`)
      this.handles.set(object, this.objects.length)
      this.objects.push({ object, kind })
    }
    const id = this.handles.get(object)
    return { $: 'h', id, k: this.objects[id].kind }
  }

  /** Return the host object of a handle. @returns {{object: object, kind: string}} */
  resolve (wire) {
    const entry = isTagged(wire, 'h') && Number.isInteger(wire.id) ? this.objects[wire.id] : undefined
    if (entry === undefined) throw new RefusedError('the value is no object of the game')
    return entry
  }

  /** Return the host object of a handle if it is of one of the kinds. @returns {object} */
  object (wire, kinds, where) {
    if (!isTagged(wire, 'h')) throw new RefusedError(`${where} must be ${kinds.join(' or ')}, found ${describeWire(wire)}`)
    const { object, kind } = this.resolve(wire)
    if (!kinds.includes(kind)) throw new RefusedError(`${where} must be ${kinds.join(' or ')}, found ${kind}`)
    return object
  }

  number (wire, where) {
    if (typeof wire === 'number' && Number.isFinite(wire)) return wire
    if (isTagged(wire, 'n') && wire.v === '-0') return -0
    throw new RefusedError(`${where} must be a finite number, found ${describeWire(wire)}`)
  }

  text (wire, where, limit = MAX_TEXT) {
    if (typeof wire !== 'string') throw new RefusedError(`${where} must be a text, found ${describeWire(wire)}`)
    if (wire.length > limit) throw new RefusedError(`${where} has ${wire.length} characters, the limit is ${limit}`)
    return wire
  }

  vector (wire, where) {
    const parts = isTagged(wire, 'v') ? wire.c : isTagged(wire, 'b') ? wire.c : coordinates(wire)
    if (!Array.isArray(parts) || parts.length !== 3) throw new RefusedError(`${where} must be a Vec3, found ${describeWire(wire)}`)
    return new Vec3(...parts.map((part, i) => this.coordinate(part, `${where}.${'xyz'[i]}`)))
  }

  coordinate (wire, where) {
    const value = this.number(wire, where)
    if (Math.abs(value) > MAX_COORDINATE) throw new RefusedError(`${where} is ${value}, outside the world`)
    return value
  }

  /** Return the block at the position that a block of the guest stands for, in its present state. */
  block (wire, where) {
    if (!isTagged(wire, 'b')) throw new RefusedError(`${where} must be a block, found ${describeWire(wire)}`)
    this.pay(BLOCK_COST)
    const position = this.vector(wire, where)
    const block = this.bot.blockAt(position)
    if (!block) throw new RefusedError(`${where}: there is no block at ${position}`)
    return block
  }

  /** Return the item in the slot that an item of the guest stands for; it must still be there. */
  item (wire, where) {
    const { slot, type } = isTagged(wire, 'i') ? wire : {}
    if (!Number.isInteger(slot) || slot < 0) throw new RefusedError(`${where} must be an item, found ${describeWire(wire)}`)
    for (const window of [this.bot.inventory, this.bot.currentWindow]) {
      const item = window?.slots[slot]
      if (item && item.type === type) return item
    }
    throw new RefusedError(`${where}: the item is not in slot ${slot} any more`)
  }

  /** Return a block for the guest. Properties that all blocks of a state share are sent only once. */
  blockToGuest (block) {
    const { x, y, z } = block.position
    if (!this.states.has(block.stateId)) this.states.set(block.stateId, block)
    const wire = { $: 'b', s: block.stateId, c: [x, y, z], l: [block.light ?? 0, block.skyLight ?? 0] }
    const text = frontText(block)
    return text === '' ? wire : { ...wire, t: text }
  }

  /** Return a block of a state that was sent to the guest. @returns {object} */
  blockOfState (id) {
    if (!this.states.has(id)) throw new RefusedError('no block of that state was handed over')
    return this.states.get(id)
  }

  functionOf (wire, where) {
    if (!isTagged(wire, 'f') || !Number.isSafeInteger(wire.id)) throw new RefusedError(`${where} must be a function, found ${describeWire(wire)}`)
    return this.functionFor(wire.id)
  }

  /** Convert any value from the guest, such as arguments of skills and results of callbacks. */
  toHost (wire, where, depth = 0) {
    if (depth > MAX_DEPTH) throw new RefusedError(`${where} is nested more than ${MAX_DEPTH} deep`)
    if (wire === null || typeof wire === 'boolean') return wire
    if (typeof wire === 'number') return this.number(wire, where)
    if (typeof wire === 'string') return this.text(wire, where)
    if (Array.isArray(wire)) return this.list(wire, where, depth)
    switch (wire.$) {
      case 'u': return undefined
      case 'n': return this.number(wire, where)
      case 'v': return this.vector(wire, where)
      case 'h': return this.resolve(wire).object
      case 'b': return this.block(wire, where)
      case 'i': return this.item(wire, where)
      case 'f': return this.functionOf(wire, where)
      case 'g': return buildGoal(this, wire, where)
      case 'm': return buildMovements(this, wire, where)
      case 'o': return this.record(wire, where, depth)
      case 'e': return { name: this.text(wire.name, where), message: this.text(wire.message, where) }
      default: throw new RefusedError(`${where} is of an unknown form`)
    }
  }

  list (wire, where, depth) {
    if (wire.length > MAX_ELEMENTS) throw new RefusedError(`${where} has ${wire.length} elements, the limit is ${MAX_ELEMENTS}`)
    return wire.map((item, i) => this.toHost(item, `${where}[${i}]`, depth + 1))
  }

  record (wire, where, depth = 0) {
    if (!isTagged(wire, 'o') || !Array.isArray(wire.o)) throw new RefusedError(`${where} must be an object, found ${describeWire(wire)}`)
    if (wire.o.length > MAX_ELEMENTS) throw new RefusedError(`${where} has ${wire.o.length} keys, the limit is ${MAX_ELEMENTS}`)
    const record = {}
    for (const [key, value] of wire.o) {
      if (typeof key !== 'string' || FORBIDDEN_KEYS.has(key)) throw new RefusedError(`${where} has the key ${typeof key === 'string' ? cut(key, SHOWN) : describeWire(key)}, which is not allowed`)
      record[key] = this.toHost(value, `${where}.${key}`, depth + 1)
    }
    return record
  }

  /** Convert any value for the guest: data is copied; game objects are named by handles or copied. */
  toGuest (value, where, depth = 0) {
    if (depth > MAX_DEPTH) throw new RefusedError(`${where} is nested more than ${MAX_DEPTH} deep`)
    switch (typeof value) {
      case 'boolean': case 'string': return value
      case 'number': return numberToGuest(value)
      case 'undefined': return { $: 'u' }
      case 'object': return value === null ? null : this.objectToGuest(value, where, depth)
      default: throw new RefusedError(`${where} is a ${typeof value}, which a program cannot have`)
    }
  }

  objectToGuest (value, where, depth) {
    if (Array.isArray(value)) return value.map((item, i) => this.toGuest(item, `${where}[${i}]`, depth + 1))
    if (isVector(value)) return vectorToGuest(value)
    const kind = this.kindOf(value)
    if (kind === 'block') return this.blockToGuest(value)
    if (kind === 'item') return itemToGuest(value)
    if (kind !== null) return this.handle(value, kind)
    const prototype = Object.getPrototypeOf(value)
    if (prototype !== null && prototype !== Object.prototype) {
      throw new RefusedError(`${where} is a ${prototype.constructor?.name ?? 'foreign object'}, which a program cannot have`)
    }
    return { $: 'o', o: Object.entries(value).map(([key, item]) => [key, this.toGuest(item, `${where}.${key}`, depth + 1)]) }
  }
}

/**
 * Return the text on the front of a sign, without empty lines at the end; empty for any other block.
 * @returns {string}
 */
function frontText (block) {
  if (!block.entity || !block.name.endsWith('_sign')) return ''
  return block.getSignText()[0].replace(/\n+$/, '')
}

function isTagged (wire, tag) {
  return wire !== null && typeof wire === 'object' && !Array.isArray(wire) && wire.$ === tag
}

// Accept plain {x, y, z} objects as well, because programs write them.
function coordinates (wire) {
  if (!isTagged(wire, 'o') || !Array.isArray(wire.o)) return undefined
  const values = new Map(wire.o)
  return ['x', 'y', 'z'].every((key) => values.has(key)) ? ['x', 'y', 'z'].map((key) => values.get(key)) : undefined
}

const TAG_NAMES = { u: 'undefined', v: 'a Vec3', h: 'an object of the game', b: 'a block', i: 'an item', f: 'a function', g: 'a goal', m: 'movements', o: 'an object', e: 'an error' }

/** Return the description of a value of the guest for messages. @returns {string} */
function describeWire (wire) {
  if (wire === null) return 'null'
  if (Array.isArray(wire)) return 'an array'
  if (typeof wire === 'string') return `the text "${cut(wire, SHOWN)}"`
  if (typeof wire !== 'object') return String(wire)
  if (wire.$ === 'n') return ['NaN', 'Infinity', '-Infinity', '-0'].includes(wire.v) ? wire.v : 'an unknown number'
  return Object.hasOwn(TAG_NAMES, wire.$) ? TAG_NAMES[wire.$] : 'a value of unknown form'
}

function isVector (value) {
  return typeof value.x === 'number' && typeof value.y === 'number' && typeof value.z === 'number' && typeof value.distanceTo === 'function'
}

function numberToGuest (value) {
  return Number.isFinite(value) && !Object.is(value, -0) ? value : { $: 'n', v: Object.is(value, -0) ? '-0' : String(value) }
}

function vectorToGuest ({ x, y, z }) {
  if (![x, y, z].every(part => typeof part === 'number')) throw new TypeError('the value is no position')
  return { $: 'v', c: [x, y, z].map(numberToGuest) }
}

const ITEM_FIELDS = ['type', 'count', 'metadata', 'name', 'displayName', 'stackSize', 'slot', 'maxDurability', 'durabilityUsed']

function itemToGuest (item) {
  const fields = ITEM_FIELDS.filter((field) => item[field] !== undefined)
  return { $: 'i', d: { $: 'o', o: fields.map((field) => [field, item[field] === null ? null : numberOrText(item[field])]) } }
}

function numberOrText (value) {
  return typeof value === 'number' ? numberToGuest(value) : String(value)
}

module.exports = { Exchange, RefusedError, describeWire, isTagged, numberToGuest, vectorToGuest, itemToGuest }
