'use strict'

const { vectorOf, clockwise, counterclockwise } = require('./lib/directions')
const { planPlacement, hitsSomebody } = require('./lib/placedBlocks')
const { withCount } = require('./lib/items')
const { listOf } = require('./lib/positions')

/** Add the placing of blocks: in the state that the game gives them, not inside anybody, one item each. */
module.exports.server = (serv) => {
  const fits = ([position, state]) => !hitsSomebody(serv.players, serv.blocks.describe(state).shapes, position)

  /** Turn the single chest that a new chest joins into the other half. */
  function joinChests (position, player) {
    const { name, properties } = serv.blocks.at(position)
    if (!/^(trapped_)?chest$/.test(name) || properties.type === 'single') return
    const turn = properties.type === 'left' ? clockwise : counterclockwise
    const other = position.plus(vectorOf(turn(properties.facing)))
    const type = properties.type === 'left' ? 'right' : 'left'
    serv.blocks.set(other, serv.blocks.stateWith(serv.blocks.at(other), { type }), player)
  }

  /** Use the item in hand on a block. Return true if that had an effect. */
  serv.useItemOn = (use) => {
    const { player, hand } = use
    const item = player.itemInHand(hand)
    const plan = item && planPlacement(serv.registry, serv.blocks, use, item)
    // The position must be visible from the eye: nobody places a block through a wall onto its far side.
    if (!plan || !plan.states.every(fits) || !player.canSee(plan.position)) return false
    plan.states.forEach(([position, state]) => serv.blocks.set(position, state, player))
    joinChests(plan.position, player)
    player.inventory.slots[player.slotOfHand(hand)] = withCount(item, item.count - 1)
    player.inventoryChanged()
    player.emitEvent({
      kind: 'place_block',
      detail: { position: listOf(plan.position), block: serv.blocks.text(plan.states[0][1]) },
    })
    return true
  }
}
