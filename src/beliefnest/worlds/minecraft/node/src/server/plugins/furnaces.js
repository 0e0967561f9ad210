'use strict'

const { INPUT, FUEL, OUTPUT, SIZE, coldFire, arrange, burn } = require('./lib/fire')
const { KINDS, resultOf, ticksOf, burnTicks } = require('./lib/smelting')
const { cell, containerMenu } = require('./lib/menus')
const { withCount } = require('./lib/items')
const { byPlace, keyOf, vecOf } = require('./lib/positions')

const WINDOWS = { blast_furnace: 10, furnace: 14, smoker: 22 }
const TITLES = { blast_furnace: 'Blast Furnace', furnace: 'Furnace', smoker: 'Smoker' }

/**
 * Return the rules of a furnace's slots: any item into the input, fuels (and buckets) into the fuel slot, nothing into
 * the output.
 */
function rules (kind) {
  const smelts = (item) => resultOf(kind, item.name) !== undefined
  const burns = (item) => burnTicks(item.name) > 0
  return {
    mayPlace: (i, item) => i === INPUT || (i === FUEL && (burns(item) || item.name === 'bucket')),
    into: (item) => {
      if (!item) return []
      if (smelts(item)) return [INPUT]
      return burns(item) ? [FUEL] : []
    },
  }
}

/** Return the output slot, which only gives items; taking an item counts as smelting it. */
function outputCell (slots, player) {
  const { get, set } = cell(slots, OUTPUT)
  return {
    get,
    set (item) {
      const there = get()
      const taken = (there?.count ?? 0) - (item?.count ?? 0)
      if (taken > 0) player.countAct('smelt_item', withCount(there, taken))
      set(item)
    },
  }
}

/** Add furnaces, blast furnaces and smokers: windows, fuel, and smelting tick by tick. */
module.exports.server = (serv) => {
  const fires = new Map()
  const makeItem = (name, count) => new serv.Item(serv.registry.itemsByName[name].id, count)
  const isFurnace = (position) => KINDS.includes(serv.blocks.at(position).name)
  for (const kind of KINDS) serv.containers.define(kind, SIZE, (stacks) => arrange(kind, stacks))

  function fireAt (position) {
    const key = keyOf(position)
    if (!fires.has(key)) fires.set(key, { position: vecOf(position), ...coldFire() })
    return fires.get(key)
  }

  function showProgress (fire, kind) {
    const values = [fire.left, fire.whole, fire.done, ticksOf(kind)]
    for (const { _client, windows } of serv.containers.viewers(fire.position)) {
      values.forEach((value, property) => _client.write('craft_progress_bar', { windowId: windows.opened.id, property, value }))
    }
  }

  function tick (position) {
    const block = serv.blocks.at(position)
    const fire = fireAt(position)
    const changed = burn(fire, block.name, serv.containers.slots(position), makeItem)
    if (changed) serv.containers.touch(position)
    const lit = fire.left > 0
    if (block.properties.lit !== lit) serv.blocks.set(position, serv.blocks.stateWith(block, { lit }))
    if (lit || fire.done > 0) showProgress(fire, block.name)
  }
  serv.onTick((within) => serv.containers.positions(within).filter(isFurnace).forEach(tick))

  function open ({ player, position, block: { name } }) {
    const slots = serv.containers.slots(position)
    const menu = containerMenu(slots.map((_, i) => (i === OUTPUT ? outputCell(slots, player) : cell(slots, i))), player, rules(name))
    player.lookInto({ type: WINDOWS[name], title: TITLES[name], positions: [vecOf(position)], menu })
    showProgress(fireAt(position), name)
    return true
  }
  KINDS.forEach((kind) => serv.onInteraction(kind, open))

  serv.blocks.on('change', ({ position, before, after }) => {
    if (serv.blocks.describe(before).name !== serv.blocks.describe(after).name) fires.delete(keyOf(position))
  })
  function putOut (within) {
    for (const [key, { position }] of fires) if (within(position)) fires.delete(key)
  }
  serv.onForget(putOut)

  serv.keeps('fires', {
    save: (region) => [...fires.values()]
      .filter(({ position, left, done }) => region.contains(position) && (left > 0 || done > 0))
      .map(({ position, left, whole, done }) => [...region.toScenario(position), left, whole, done]).sort(byPlace),
    restore (rows, region) {
      putOut((place) => region.contains(place))
      for (const [x, y, z, left, whole, done] of rows) {
        const position = region.toServer([x, y, z])
        if (isFurnace(position)) Object.assign(fireAt(position), { left, whole, done })
      }
    },
  })
}
