'use strict'

const { isDeepStrictEqual } = require('node:util')
const { HOTBAR_START } = require('./lib/menus')
const { equal, rowsOf, slotsOf } = require('./lib/items')
const { layOut, possessionsOf, storage, STORE_ORDER } = require('./lib/slots')
const { store } = require('./lib/clicks')

/** Add inventories, as slots and as counts by name. They are kept while a player is away. */
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
  /** Forget a player who has left, so that a later one of that name starts empty. */
  serv.forgetPlayer = (uuid) => left().delete(uuid)

  serv.keeps('slots', {
    save: () => serv.players.flatMap((player) => {
      const slots = player.saveSlots()
      return slots ? [[player.agent, ...slots]] : []
    }),
    restore (rows) {
      const rowsByAgent = new Map(rows.map(([agent, ...slots]) => [agent, slots]))
      serv.players.forEach((player) => player.restoreSlots(rowsByAgent.get(player.agent)))
    },
  })
}

module.exports.player = (player, serv) => {
  player.heldItemSlot = 0
  player.inventory = serv.makeInventory()
  const recalled = () => serv.recallPlayer(player._client.uuid)

  /** Store an item. Return what did not fit, or null. */
  player.storeItem = (item) => {
    const rest = store(storage(player.inventory.slots), item, STORE_ORDER)
    player.inventoryChanged()
    return rest
  }

  // Cache the result, which is asked for at every tick. Stacks are immutable, so that identical stacks in the same
  // slots mean the same possessions.
  let last = { stacks: [], heldItemSlot: 0, possessions: null }

  /**
   * Return `{inventory: {name: count}, equipment: {slot: name}}`, with everything worn, held or on the cursor. The
   * result must not be changed.
   */
  player.possessions = () => {
    const { inventory: { slots }, heldItemSlot, windows: { cursor } } = player
    const same = last.heldItemSlot === heldItemSlot && last.stacks.length === slots.length &&
      last.stacks[0] === cursor && slots.every((item, i) => i === 0 || item === last.stacks[i])
    if (!same) {
      // Slot 0 shows the result of crafting, which nobody owns yet.
      const stacks = [cursor, ...slots.slice(1)]
      last = { stacks, heldItemSlot, possessions: possessionsOf(stacks, stacks[HOTBAR_START + heldItemSlot]) }
    }
    return last.possessions
  }

  /** Set the possessions of the player. @throws RangeError if they do not fit */
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

  /** Return `[held, ...[slot, name, count]]`; null if `setPossessions` would fill the slots in the same way. */
  player.saveSlots = () => {
    const { slots } = player.inventory
    const asUsual = player.heldItemSlot === 0 && usual().every((item, i) => equal(item, slots[i]))
    return asUsual ? null : [player.heldItemSlot, ...rowsOf(slots)]
  }

  /** Fill the slots as `saveSlots` returned them. */
  player.restoreSlots = ([heldSlot, ...rows] = [0]) => {
    const before = player.possessions()
    const plain = usual()
    carry(heldSlot, slotsOf(serv.Item, serv.registry, rows, player.inventory.slots.length))
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
