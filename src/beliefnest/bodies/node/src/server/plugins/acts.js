'use strict'

/**
 * What is done with items by one click or step and often many times a tick: crafting, taking what was
 * smelted, giving, receiving. Counted where it happens (`player.countAct`), told once a tick.
 */
module.exports.server = (serv) => {
  // What is counted later in the order of plugins is told at the next tick, or when the player rests.
  serv.onTick(() => serv.players.forEach((player) => player.tellActs()))
}

module.exports.player = (player) => {
  let counted = new Map()

  /**
   * @param {string} kind of the event
   * @param {object} item and how many of it
   * @param {string} [other] the agent it was done with
   */
  player.countAct = (kind, { name, count }, other) => {
    const key = other === undefined ? kind : `${kind} ${other}`
    const { items } = counted.get(key) ?? counted.set(key, { kind, other, items: {} }).get(key)
    items[name] = (items[name] ?? 0) + count
  }

  player.tellActs = () => {
    const told = [...counted.values()]
    counted = new Map()
    for (const { kind, other, items } of told) player.emitEvent({ kind, detail: other === undefined ? { items } : { other, items } })
  }
  for (const end of ['rest', 'disconnected']) player.on(end, () => player.tellActs())
}
