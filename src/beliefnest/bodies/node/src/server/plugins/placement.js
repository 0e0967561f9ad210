'use strict'

const { vectorOf, clockwise, counterclockwise } = require('./lib/directions')
const { planPlacement, hitsSomebody } = require('./lib/plan')
const { withCount } = require('./lib/items')
const { listOf } = require('./lib/positions')

/** Putting blocks: in the state the game gives them, not into anybody, one item each. */
module.exports.server = (serv) => {
  const fits = ([position, state]) => !hitsSomebody(serv.players, serv.blocks.describe(state).shapes, position)

  /** The neighbour a new half of a double chest joins becomes the other half. */
  function joinChests (position, player) {
    const { name, properties } = serv.blocks.at(position)
    if (!/^(trapped_)?chest$/.test(name) || properties.type === 'single') return
    const turn = properties.type === 'left' ? clockwise : counterclockwise
    const other = position.plus(vectorOf(turn(properties.facing)))
    const type = properties.type === 'left' ? 'right' : 'left'
    serv.blocks.set(other, serv.blocks.stateWith(serv.blocks.at(other), { type }), player)
  }

  /** What the item in hand does to the block it is used on; returns whether it did something. */
  serv.useItemOn = (use) => {
    const { player, hand } = use
    const item = player.itemInHand(hand)
    const plan = item && planPlacement(serv.registry, serv.blocks, use, item)
    // Seen from where the hand is: not through a wall to its far side.
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
