'use strict'

const { Vec3 } = require('vec3')
const { FACES } = require('./lib/directions')
const { vecOf } = require('./lib/positions')
const { HOTBAR_START, OFF_HAND } = require('./lib/menus')
const { eyeAbove, inReach, sees } = require('../../../../../../skills/code/lib/sight')

/**
 * Add the use of blocks: first the block's own handler runs (`serv.onInteraction(name, handler)`; it gets `{player,
 * position, block, face, cursor}` and returns whether it did something), then that of the item in hand
 * (`serv.useItemOn`). A block can be used only if a free line leads to it from the eye.
 */
module.exports.server = (serv) => {
  const handlers = new Map()

  serv.onInteraction = (name, handler) => { handlers.set(name, handler) }
  serv.interact = (use) => handlers.get(use.block.name)?.(use) ?? false
}

module.exports.player = (player, serv) => {
  const client = player._client
  client.on('entity_action', ({ actionId }) => {
    if (actionId === 'start_sneaking' || actionId === 0) player.crouching = true
    if (actionId === 'stop_sneaking' || actionId === 1) player.crouching = false
  })

  const shapesAt = (x, y, z) => serv.blocks.at(new Vec3(x, y, z)).shapes

  player.eyes = () => eyeAbove(player.position, player.crouching)
  player.canReach = (position) => inReach(player.eyes(), position)
  player.canSee = (position) => sees(shapesAt, player.eyes(), position)
  player.canUse = (position) => player.canReach(position) && player.canSee(position)
  player.slotOfHand = (hand) => (hand === 1 ? OFF_HAND : HOTBAR_START + player.heldItemSlot)
  player.itemInHand = (hand = 0) => player.inventory.slots[player.slotOfHand(hand)] ?? null

  /** Acknowledge an act. The client predicted its effect and drops the prediction now. */
  player.acknowledge = (sequence, positions) => {
    client.write('acknowledge_player_digging', { sequenceId: sequence ?? 0 })
    positions.forEach((position) => serv.blocks.send(player, position))
  }

  function use (packet, position) {
    const block = serv.blocks.at(position)
    const bareHands = !player.itemInHand(0) && !player.itemInHand(1)
    const use = {
      player,
      position,
      block,
      face: packet.direction,
      cursor: { x: packet.cursorX, y: packet.cursorY, z: packet.cursorZ },
      hand: packet.hand ?? 0,
    }
    if ((!player.crouching || bareHands) && player.canSee(position) && serv.interact(use)) return
    serv.useItemOn(use)
  }

  client.on('block_place', (packet) => {
    if (!(packet.direction >= 0 && packet.direction < FACES.length)) return
    const position = vecOf(packet.location)
    if (player.health > 0 && player.canReach(position)) use(packet, position)
    player.acknowledge(packet.sequence, [position, position.plus(FACES[packet.direction])])
  })
}
