'use strict'

const { KINDS, resultOf, ticksOf, burnTicks } = require('./lib/smelting')
const { createLedger } = require('./lib/ledger')
const { withCount } = require('./lib/items')
const { cell, containerMenu } = require('./lib/menus')
const { keyOf, listOf, vecOf } = require('./lib/positions')

const [INPUT, FUEL, OUTPUT] = [0, 1, 2]
const SIZE = 3
const WINDOWS = { blast_furnace: 10, furnace: 14, smoker: 22 }
const TITLES = { blast_furnace: 'Blast Furnace', furnace: 'Furnace', smoker: 'Smoker' }
const COOLING = 2

/** Furnaces, blast furnaces and smokers: windows, fuel, and smelting tick by tick. */
module.exports.server = (serv) => {
  const fires = new Map()
  const isFurnace = (position) => KINDS.includes(serv.blocks.at(position).name)

  function arrangement (kind, stacks) {
    const slots = new Array(SIZE).fill(null)
    for (const stack of stacks) {
      const wanted = [resultOf(kind, stack.name) && INPUT, burnTicks(stack.name) > 0 && FUEL, OUTPUT, FUEL, INPUT]
      const slot = wanted.find((place) => Number.isInteger(place) && slots[place] === null)
      if (slot === undefined) return null
      slots[slot] = stack
    }
    return slots
  }
  for (const kind of KINDS) serv.containers.define(kind, SIZE, (stacks) => arrangement(kind, stacks))

  function fireAt (position) {
    const key = keyOf(position)
    if (!fires.has(key)) fires.set(key, { position: vecOf(position), left: 0, whole: 0, done: 0 })
    return fires.get(key)
  }

  /** What would come out next, or null if nothing can. */
  function product (kind, slots) {
    const name = slots[INPUT] && resultOf(kind, slots[INPUT].name)
    if (!name) return null
    const { id, stackSize } = serv.registry.itemsByName[name]
    const out = slots[OUTPUT]
    if (out && (out.type !== id || out.count >= stackSize)) return null
    return new serv.Item(id, (out?.count ?? 0) + 1)
  }

  function light (fire, slots) {
    const fuel = slots[FUEL]
    fire.whole = fire.left = fuel ? burnTicks(fuel.name) : 0
    if (!fire.left) return false
    const bucket = fuel.name === 'lava_bucket' ? new serv.Item(serv.registry.itemsByName.bucket.id, 1) : null
    slots[FUEL] = withCount(fuel, fuel.count - 1) ?? bucket
    return true
  }

  /** One tick; returns whether a slot changed. */
  function burn (fire, kind, slots) {
    let changed = false
    if (fire.left > 0) fire.left -= 1
    const next = product(kind, slots)
    if (next && fire.left === 0) changed = light(fire, slots)
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

  function showProgress (fire, kind) {
    const values = [fire.left, fire.whole, fire.done, ticksOf(kind)]
    for (const player of serv.players) {
      const { open } = player.windows
      if (!open?.positions?.some((position) => keyOf(position) === keyOf(fire.position))) continue
      values.forEach((value, property) => player._client.write('craft_progress_bar', { windowId: open.id, property, value }))
    }
  }

  function tick (position) {
    const block = serv.blocks.at(position)
    const fire = fireAt(position)
    if (burn(fire, block.name, serv.containers.slots(position))) serv.containers.touch(position)
    const lit = fire.left > 0
    if (block.properties.lit !== lit) serv.blocks.set(position, serv.blocks.stateWith(block, { lit }))
    if (lit || fire.done > 0) showProgress(fire, block.name)
  }
  serv.onTick((within) => serv.containers.positions(within).filter(isFurnace).forEach(tick))

  function open ({ player, position, block }) {
    const kind = block.name
    const slots = serv.containers.slots(position)
    const ledger = createLedger([position], serv.containers.slots)
    const positions = [vecOf(position)]
    const smelts = (item) => resultOf(kind, item.name) !== undefined
    player.openWindow({
      type: WINDOWS[kind],
      title: TITLES[kind],
      positions,
      menu: containerMenu(slots.map((_, i) => cell(slots, i)), player, {
        mayPlace: (i, item) => i === INPUT || (i === FUEL && (burnTicks(item.name) > 0 || item.name === 'bucket')),
        into: (item) => (item && smelts(item) ? [INPUT] : item && burnTicks(item.name) > 0 ? [FUEL] : []),
      }),
      around: (run) => ledger.record(run).forEach(serv.containers.touch),
    })
    player.ledgers.push({ ledger, isOpen: () => player.windows.open?.positions === positions })
    player.emitEvent({ kind: 'open_container', detail: { position: listOf(position) } })
    showProgress(fireAt(position), kind)
    return true
  }
  KINDS.forEach((kind) => serv.onInteraction(kind, open))

  serv.blocks.on('change', ({ position, before, after }) => {
    if (serv.blocks.describe(before).name !== serv.blocks.describe(after).name) fires.delete(keyOf(position))
  })
  serv.onForget((within) => {
    for (const [key, { position }] of fires) if (within(position)) fires.delete(key)
  })
}
