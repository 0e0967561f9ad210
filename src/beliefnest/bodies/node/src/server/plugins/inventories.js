'use strict'

const { isDeepStrictEqual } = require('node:util')
const { INVENTORY_START, HOTBAR_START, OFF_HAND } = require('./lib/menus')
const { countByName, equal, rowsOf, slotsOf, stacksOf } = require('./lib/items')
const { store } = require('./lib/clicks')

const WORN = { head: 5, chest: 6, legs: 7, feet: 8, off_hand: OFF_HAND }
/** Where new items go: hotbar first, as in the game. */
const STORE_ORDER = [
  ...Array.from({ length: 9 }, (_, i) => HOTBAR_START + i),
  ...Array.from({ length: HOTBAR_START - INVENTORY_START }, (_, i) => INVENTORY_START + i),
]

/** What a player has, as slots and as name -> count; kept over a quit and a rejoin. */
module.exports.server = (serv) => {
  const byRegion = new WeakMap()
  const left = () => {
    if (!byRegion.has(serv.region)) byRegion.set(serv.region, new Map())
    return byRegion.get(serv.region)
  }

  const windows = require('prismarine-windows')(serv.registry)
  serv.makeInventory = () => windows.createWindow(0, 'minecraft:inventory', 'Inventory')

  serv.rememberPlayer = (player) => {
    left().set(player.uuid, {
      slots: [...player.inventory.slots],
      heldItemSlot: player.heldItemSlot,
      health: player.health,
      food: player.food,
    })
  }
  serv.recallPlayer = (uuid) => left().get(uuid)
  /** Makes a player who has left unknown, so that a later one of that name starts empty. */
  serv.forgetPlayer = (uuid) => left().delete(uuid)

  serv.keeps('slots', {
    save: () => serv.players.flatMap((player) => {
      const slots = player.saveSlots()
      return slots ? [[player.agent, ...slots]] : []
    }),
    restore (rows) {
      const told = new Map(rows.map(([agent, ...slots]) => [agent, slots]))
      serv.players.forEach((player) => player.restoreSlots(told.get(player.agent)))
    },
  })
}

function storage (slots) {
  return {
    get: (i) => slots[i] ?? null,
    set: (i, item) => { slots[i] = item; },
    mayPlace: () => true,
    limit: (_, item) => item.stackSize,
  }
}

/** The slots of one who was given this and holds the first slot of the hotbar. */
function layOut ({ Item, registry }, size, { inventory, equipment }, who) {
  const slots = new Array(size).fill(null)
  const rest = { ...inventory }
  const take = (name) => {
    if (!(rest[name] > 0)) throw new RangeError(`${who} cannot wear or hold ${name}: the inventory has none`)
    rest[name] -= 1
    return new Item(registry.itemsByName[name].id, 1)
  }
  for (const [part, slot] of Object.entries(WORN)) {
    if (equipment[part]) slots[slot] = take(equipment[part])
  }
  const [held, ...others] = STORE_ORDER
  if (equipment.main_hand) slots[held] = take(equipment.main_hand)
  const free = equipment.main_hand ? STORE_ORDER : [...others, held]
  for (const stack of stacksOf(Item, registry, rest)) {
    const inOffHand = slots[OFF_HAND]?.name === stack.name ? [OFF_HAND] : []
    if (store(storage(slots), stack, [...free, ...inOffHand])) {
      throw new RangeError(`the inventory given to ${who} does not fit in 36 slots: ${stack.name} is left over`)
    }
  }
  return slots
}

function possessionsOf (stacks, held) {
  const equipment = {}
  for (const [part, slot] of Object.entries(WORN)) {
    if (stacks[slot]) equipment[part] = stacks[slot].name
  }
  if (held) equipment.main_hand = held.name
  return { inventory: countByName([...stacks.slice(1), stacks[0]]), equipment }
}

module.exports.player = (player, serv) => {
  player.heldItemSlot = 0
  player.inventory = serv.makeInventory()
  const recalled = () => serv.recallPlayer(player._client.uuid)

  /** Stores an item; returns what did not fit, or null. */
  player.storeItem = (item) => {
    const rest = store(storage(player.inventory.slots), item, STORE_ORDER)
    player.inventoryChanged()
    return rest
  }

  // Asked for at every tick; stacks are values, so that the same ones in the same places are the same possessions.
  let known = { stacks: [], heldItemSlot: 0, possessions: null }

  /** `{inventory: {name: count}, equipment: {slot: name}}`, what is worn, held or on the cursor included; not to be changed. */
  player.possessions = () => {
    const { inventory: { slots }, heldItemSlot, windows: { cursor } } = player
    const same = known.heldItemSlot === heldItemSlot && known.stacks.length === slots.length &&
      known.stacks[0] === cursor && slots.every((item, i) => i === 0 || item === known.stacks[i])
    if (!same) {
      // What lies in slot 0 is the result of crafting, which nobody has yet.
      const stacks = [cursor, ...slots.slice(1)]
      known = { stacks, heldItemSlot, possessions: possessionsOf(stacks, stacks[HOTBAR_START + heldItemSlot]) }
    }
    return known.possessions
  }

  /** Makes the player have exactly this. @throws RangeError where it cannot. */
  player.setPossessions = ({ inventory = {}, equipment = {} }) => {
    carry(0, layOut(serv, player.inventory.slots.length, { inventory, equipment }, player.username))
    player.windows.cursor = null
    player.inventoryChanged()
  }

  function carry (heldItemSlot, slots) {
    slots.forEach((item, i) => { player.inventory.slots[i] = item })
    if (player.heldItemSlot === heldItemSlot) return
    player.heldItemSlot = heldItemSlot
    player._client.write('held_item_slot', { slot: heldItemSlot })
  }

  const usual = () => layOut(serv, player.inventory.slots.length, player.possessions(), player.username)

  /** `[held, ...[slot, name, count]]`; null where `setPossessions` would fill the slots so. */
  player.saveSlots = () => {
    const { slots } = player.inventory
    const asUsual = player.heldItemSlot === 0 && usual().every((item, i) => equal(item, slots[i]))
    return asUsual ? null : [player.heldItemSlot, ...rowsOf(slots)]
  }

  /** Puts what the player has into the slots that `saveSlots` told. */
  player.restoreSlots = ([held, ...rows] = [0]) => {
    const before = player.possessions()
    const plain = usual()
    carry(held, slotsOf(serv.Item, serv.registry, rows, player.inventory.slots.length))
    if (!isDeepStrictEqual(player.possessions(), before)) carry(0, plain)
    player.inventoryChanged()
  }

  player.on('connected', () => {
    const before = recalled()
    if (before) {
      before.slots.forEach((item, i) => { player.inventory.slots[i] = item; })
      Object.assign(player, { heldItemSlot: before.heldItemSlot, health: before.health, food: before.food })
    }
    player._client.write('held_item_slot', { slot: player.heldItemSlot })
    player.windows.sendAll()
    player.inventoryChanged()
  })
  player.on('disconnected', () => {
    player.windows.close()
    serv.rememberPlayer(player)
  })
}
