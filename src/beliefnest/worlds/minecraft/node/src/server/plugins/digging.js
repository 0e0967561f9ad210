'use strict'

const { dropsOf } = require('./lib/drops')
const { listOf, vecOf } = require('./lib/positions')
const { withCount } = require('./lib/items')

const TICK_MS = 50
/** Fraction of a block's digging time that must have passed, as in the game, because clocks differ a little. */
const PATIENCE = 0.7
const STATUS = { START: 0, CANCEL: 1, FINISH: 2, DROP_STACK: 3, DROP_ONE: 4, RELEASE: 5, SWAP: 6 }
const OFF_HAND_SLOT = 45

/** Add mining at the speed of the tool in hand, and the other acts of the same packet. */
module.exports.server = (serv) => {
  const Block = require('prismarine-block')(serv.registry)

  /** Return the milliseconds that a player needs to mine a block. */
  serv.digTime = (player, stateId) => Block.fromStateId(stateId, 0).digTime(
    player.itemInHand()?.type ?? null, false, serv.blocks.at(player.eyes()).name === 'water',
    !player.onGround, player.itemInHand()?.enchants ?? [], {})

  /** Break a block for a player, with its drops. */
  serv.mine = (player, position) => {
    const block = serv.blocks.at(position)
    const drops = dropsOf(serv.registry, block, player.itemInHand(), Math.random)
    const rest = block.properties.waterlogged ? serv.blocks.state('water') : 0
    serv.blocks.set(position, rest, player)
    for (const { name, count } of drops) {
      serv.popItem(position, new serv.Item(serv.registry.itemsByName[name].id, count))
    }
    player.emitEvent({
      kind: 'mine_block', detail: { position: listOf(position), block: serv.blocks.text(block.stateId) },
    })
  }

  serv.onTick(() => serv.players.forEach((player) => player.digTick()))
}

module.exports.player = (player, serv) => {
  // `overdue` is a block whose digging the client finished too early by the server's ticks; digging continues until
  // its time has passed.
  let [digging, overdue] = [null, null]

  player.on('rest', () => { digging = overdue = null })

  const timeOf = ({ ticks }) => (ticks + 1) * TICK_MS

  player.digTick = () => {
    for (const dug of [digging, overdue]) if (dug) dug.ticks += 1
    if (overdue && !canGoOn(overdue)) overdue = null
    if (overdue && timeOf(overdue) >= serv.digTime(player, overdue.stateId)) {
      serv.mine(player, overdue.position)
      overdue = null
    }
  }

  const canMine = (position) => player.health > 0 && player.canUse(position) &&
    serv.registry.blocks[serv.blocks.at(position).type].diggable && serv.blocks.at(position).name !== 'air'

  const canGoOn = ({ position, stateId }) => canMine(position) && stateId === serv.blocks.at(position).stateId

  function start (position) {
    const { stateId } = serv.blocks.at(position)
    digging = { position, stateId, ticks: 0 }
    if (canMine(position) && serv.digTime(player, stateId) === 0) {
      digging = null
      serv.mine(player, position)
    }
  }

  /**
   * Finish digging a block. The client has waited for the full time; but from afar, or on a busy machine, packets that
   * it sent at different times may arrive together. If too few server ticks have passed, the server continues by its
   * own ticks, as in the game, and tells the client that the block is still there.
   */
  function finish (position) {
    const begun = digging
    digging = null
    if (!begun?.position.equals(position) || !canGoOn(begun)) return
    if (timeOf(begun) >= serv.digTime(player, begun.stateId) * PATIENCE) serv.mine(player, position)
    else overdue ??= begun
  }

  function drop (count) {
    const slot = player.slotOfHand(0)
    const item = player.itemInHand()
    if (!item) return
    const thrown = Math.min(count, item.count)
    player.inventory.slots[slot] = withCount(item, item.count - thrown)
    serv.tossItem(player, withCount(item, thrown))
    player.inventoryChanged()
  }

  function swapHands () {
    const { slots } = player.inventory
    const hand = player.slotOfHand(0);
    [slots[hand], slots[OFF_HAND_SLOT]] = [slots[OFF_HAND_SLOT], slots[hand]]
    player.inventoryChanged()
  }

  function dig ({ status, location, sequence }) {
    const position = vecOf(location)
    if (status === STATUS.START) start(position)
    else if (status === STATUS.CANCEL) digging = null
    else finish(position)
    player.acknowledge(sequence, [position])
  }

  player._client.on('block_dig', (packet) => {
    if (packet.status <= STATUS.FINISH) dig(packet)
    else if (packet.status === STATUS.DROP_STACK) drop(Infinity)
    else if (packet.status === STATUS.DROP_ONE) drop(1)
    else if (packet.status === STATUS.RELEASE) player.stopUsing?.()
    else if (packet.status === STATUS.SWAP) swapHands()
  })
}
