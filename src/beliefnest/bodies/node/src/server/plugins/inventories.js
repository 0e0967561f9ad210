'use strict'

const { INVENTORY_START, HOTBAR_START, OFF_HAND } = require('./lib/menus')
const { countByName, stacksOf } = require('./lib/items')
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
}

function storage (player) {
  const { slots } = player.inventory
  return {
    get: (i) => slots[i] ?? null,
    set: (i, item) => { slots[i] = item; },
    mayPlace: () => true,
    limit: (_, item) => item.stackSize,
  }
}

function setPossessions (player, serv, { inventory, equipment }) {
  const { Item } = serv
  const { slots } = player.inventory
  const rest = { ...inventory }
  const take = (name) => {
    if (!(rest[name] > 0)) throw new RangeError(`${player.username} cannot wear or hold ${name}: the inventory has none`)
    rest[name] -= 1
    return new Item(serv.registry.itemsByName[name].id, 1)
  }
  slots.fill(null)
  player.windows.cursor = null
  for (const [part, slot] of Object.entries(WORN)) {
    if (equipment[part]) slots[slot] = take(equipment[part])
  }
  const heldSlot = HOTBAR_START + player.heldItemSlot
  const order = [heldSlot, ...STORE_ORDER.filter((slot) => slot !== heldSlot)]
  if (equipment.main_hand) slots[heldSlot] = take(equipment.main_hand)
  const free = equipment.main_hand ? order : [...order.slice(1), heldSlot]
  for (const stack of stacksOf(Item, serv.registry, rest)) {
    if (store(storage(player), stack, free)) {
      throw new RangeError(`the inventory given to ${player.username} does not fit in 36 slots: ${stack.name} is left over`)
    }
  }
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
    const rest = store(storage(player), item, STORE_ORDER)
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
    setPossessions(player, serv, { inventory, equipment })
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
