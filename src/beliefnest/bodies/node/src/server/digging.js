'use strict'
/**
 * Breaking blocks. The client counts the time it takes; the server takes its word for it, and
 * drops what the block yields to the tool in hand.
 */
const { Vec3 } = require('vec3')

// Statuses of block_dig.
const FINISHED = 2
const DROP_STACK = 3
const DROP_ITEM = 4
const SWAP_HANDS = 6

module.exports.name = 'digging'

module.exports.player = (player, serv) => {
  player._client.on('block_dig', packet => {
    if (packet.status === DROP_STACK || packet.status === DROP_ITEM) dropHeld(player, serv, packet.status)
    else if (packet.status === SWAP_HANDS) swapHands(player)
    else if (packet.status === FINISHED) finish(player, serv, packet)
    else player.acknowledge(packet.sequence, [])
  })
}

function finish (player, serv, { location, sequence }) {
  const position = new Vec3(location.x, location.y, location.z)
  const block = serv.blocks.at(position)
  const { diggable } = serv.registry.blocksByName[block.name]
  if (diggable && player.region.contains(position) && player.canReach(position)) {
    serv.blocks.set(position, 0, player)
    for (const item of yieldOf(player, serv, block)) serv.popItem(position, item)
    player.emitEvent({
      kind: 'mine_block', detail: { position: [position.x, position.y, position.z], block: block.name }
    })
  }
  player.acknowledge(sequence, [position])
}

/** @returns {object[]} items; whole numbers of a drop's range, chances by the region's dice */
function yieldOf (player, serv, block) {
  const { registry, Item } = serv
  const data = registry.blocksByName[block.name]
  const tool = player.itemInHand(0)
  if (data.harvestTools && !data.harvestTools[tool?.type]) return []
  const items = []
  for (const drop of registry.blockLoot[block.name]?.drops ?? []) {
    if (drop.silkTouch || Math.random() >= chanceOf(drop)) continue
    const [least, most] = drop.stackSizeRange
    const count = least + Math.floor(Math.random() * ((most ?? least) - least + 1))
    if (count > 0) items.push(new Item(registry.itemsByName[drop.item].id, count))
  }
  return items
}

// minecraft-data shares the chances out between what comes with silk touch and what without.
function chanceOf (drop) {
  return drop.noSilkTouch ? 1 : drop.dropChance
}

function dropHeld (player, serv, status) {
  const held = player.itemInHand(0)
  if (!held) return
  const count = status === DROP_STACK ? held.count : 1
  const rest = held.count - count
  const item = stack => (stack === 0 ? null : new serv.Item(held.type, stack, held.metadata, held.nbt))
  player.inventory.slots[player.slotOfHand(0)] = item(rest)
  serv.tossItem(player, item(count))
  player.inventoryChanged()
}

function swapHands (player) {
  const { slots } = player.inventory
  const [main, off] = [player.slotOfHand(0), player.slotOfHand(1)]
  const held = slots[main]
  slots[main] = slots[off]
  slots[off] = held
  player.inventoryChanged()
}
