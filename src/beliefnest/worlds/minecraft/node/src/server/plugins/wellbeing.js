'use strict'

const { withCount } = require('./lib/items')

const SAFE_FALL = 3
/** Lowest health: agents do not die, because a dead agent could not act any more. */
const LEAST_HEALTH = 1
const FULL = 20
const EATING_TICKS = 32
const EATEN = 9

/** Add health and food: falls hurt, eating fills. Hunger does not increase by itself. */
module.exports.server = (serv) => {
  serv.onTick(() => serv.players.forEach((player) => player.eatTick()))
  serv.keeps('falls', {
    save: () => serv.players.filter(({ onGround, fallsFrom }) => !onGround && fallsFrom !== null)
      .map(({ agent, fallsFrom }) => [agent, fallsFrom]),
    restore (rows) {
      const heights = new Map(rows)
      for (const player of serv.players) player.fallsFrom = heights.get(player.agent) ?? null
    },
  })
}

module.exports.player = (player, serv) => {
  const client = player._client
  player.fallsFrom = null
  let eating = null

  function land (y) {
    const damage = Math.ceil(player.fallsFrom - y - SAFE_FALL)
    player.fallsFrom = null
    if (damage > 0) player.updateHealth(Math.max(LEAST_HEALTH, player.health - damage))
  }

  function follow ({ y, onGround }) {
    const inWater = serv.blocks.at(player.position).name === 'water'
    player.fallsFrom = inWater ? y : Math.max(player.fallsFrom ?? y, y)
    if (onGround) land(y)
  }
  client.on('position', follow)
  client.on('position_look', follow)

  const food = (item) => item && serv.registry.foodsByName[item.name]

  client.on('use_item', ({ hand, sequence }) => {
    const item = player.itemInHand(hand)
    client.write('acknowledge_player_digging', { sequenceId: sequence ?? 0 })
    if (!food(item) || (player.food >= FULL && !/golden_apple/.test(item.name))) return
    eating = { slot: player.slotOfHand(hand), type: item.type, ticks: 0 }
  })
  player.stopUsing = () => { eating = null }
  player.on('rest', player.stopUsing)

  function eat (slot) {
    const item = player.inventory.slots[slot]
    player.inventory.slots[slot] = withCount(item, item.count - 1)
    player.updateFood(Math.min(FULL, player.food + food(item).foodPoints))
    client.write('entity_status', { entityId: player.id, entityStatus: EATEN })
    player.inventoryChanged()
  }

  player.eatTick = () => {
    if (!eating) return
    const still = player.inventory.slots[eating.slot]?.type === eating.type
    eating.ticks += 1
    if (still && eating.ticks < EATING_TICKS) return
    const { slot } = eating
    eating = null
    if (still) eat(slot)
  }
}
