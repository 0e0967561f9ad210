'use strict'

const { equal } = require('./lib/items')
const { HOTBAR_START, OFF_HAND } = require('./lib/menus')

/** Equipment slots of the protocol, each with its inventory slot; null for the held slot. */
const PARTS = [[0, null], [1, OFF_HAND], [2, 8], [3, 7], [4, 6], [5, 5]]
const HOTBAR_SIZE = 9

/** Show a player's equipment to nearby players whenever it changes. */
module.exports.player = (player, serv) => {
  const { Item } = serv
  const shown = new Array(PARTS.length).fill(null)

  const worn = () => PARTS.map(([, slot]) =>
    player.inventory.slots[slot ?? HOTBAR_START + player.heldItemSlot] ?? null)
  const entry = (item, part) => ({ slot: PARTS[part][0], item: Item.toNotch(item) })

  function send (others, equipments) {
    if (!equipments.length) return
    for (const other of others) {
      other._client.write('entity_equipment', { entityId: player.id, equipments })
    }
  }

  /** Send changes since the last call to nearby players. */
  player.refreshEquipment = () => {
    const now = worn()
    const changes = now.flatMap((item, part) => (equal(item, shown[part]) ? [] : [entry(item, part)]))
    now.forEach((item, part) => { shown[part] = item; })
    send(serv.players.filter((other) => other !== player), changes)
  }

  /**
   * Send one player all equipment, including empty hands: bots distinguish a slot that was never filled from one that
   * was emptied.
   */
  player.showEquipment = (other) => send([other], worn().map(entry))

  player._client.on('held_item_slot', ({ slotId }) => {
    if (!(slotId >= 0 && slotId < HOTBAR_SIZE)) return
    player.heldItemSlot = slotId
    player.refreshEquipment()
  })
}
