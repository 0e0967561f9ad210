'use strict'

const { resultOf, ticksOf, burnTicks } = require('./smelting')
const { withCount } = require('./items')

/** Slots of a furnace. */
const INPUT = 0
const FUEL = 1
const OUTPUT = 2
const SIZE = 3
/** Progress that a smelting loses per tick without fire. */
const COOLING = 2

/**
 * Return a furnace that has not been lit: `left` of the fuel's `whole` ticks remain, `done` ticks of the smelting are
 * done.
 */
const coldFire = () => ({ left: 0, whole: 0, done: 0 })

/** Return the slots for given stacks; null if they do not fit. */
function arrange (kind, stacks) {
  const slots = new Array(SIZE).fill(null)
  for (const stack of stacks) {
    const wanted = []
    if (resultOf(kind, stack.name)) wanted.push(INPUT)
    if (burnTicks(stack.name) > 0) wanted.push(FUEL)
    const slot = [...wanted, OUTPUT, FUEL, INPUT].find((place) => slots[place] === null)
    if (slot === undefined) return null
    slots[slot] = stack
  }
  return slots
}

/** Return the next product; null if nothing can be smelted. */
function product (kind, slots, makeItem) {
  const name = slots[INPUT] && resultOf(kind, slots[INPUT].name)
  if (!name) return null
  const out = slots[OUTPUT]
  if (out && (out.name !== name || out.count >= out.stackSize)) return null
  return makeItem(name, (out?.count ?? 0) + 1)
}

function light (fire, slots, makeItem) {
  const fuel = slots[FUEL]
  fire.whole = fuel ? burnTicks(fuel.name) : 0
  fire.left = fire.whole
  if (fire.left === 0) return false
  const bucket = fuel.name === 'lava_bucket' ? makeItem('bucket', 1) : null
  slots[FUEL] = withCount(fuel, fuel.count - 1) ?? bucket
  return true
}

/**
 * Advance a furnace by one tick; this changes `fire` and `slots`.
 * @param {(name: string, count: number) => object} makeItem
 * @returns {boolean} true if a slot changed
 */
function burn (fire, kind, slots, makeItem) {
  let changed = false
  if (fire.left > 0) fire.left -= 1
  const next = product(kind, slots, makeItem)
  if (next && fire.left === 0) changed = light(fire, slots, makeItem)
  if (!next || fire.left === 0) {
    fire.done = next ? Math.max(0, fire.done - COOLING) : 0
    return changed
  }
  fire.done += 1
  if (fire.done < ticksOf(kind)) return changed
  fire.done = 0
  slots[OUTPUT] = next
  slots[INPUT] = withCount(slots[INPUT], slots[INPUT].count - 1)
  return true
}

module.exports = { INPUT, FUEL, OUTPUT, SIZE, coldFire, arrange, burn }
