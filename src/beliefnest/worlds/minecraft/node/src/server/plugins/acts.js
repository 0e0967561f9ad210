'use strict'

/**
 * Counter of acts on items that happen many times a tick: crafting, taking smelted items, giving, receiving. Plugins
 * count them where they happen (`player.countAct`); the counts are reported once a tick.
 */
module.exports.server = (serv) => {
  // Acts that a later plugin counts in the same tick are reported at the next tick, or when the player rests.
  serv.onTick(() => serv.players.forEach((player) => player.tellActs()))
}

module.exports.player = (player) => {
  let counted = new Map()

  /**
   * Count an act.
   * @param {string} kind kind of the event
   * @param {object} item item, with its count
   * @param {string} [other] agent with whom it was done
   */
  player.countAct = (kind, { name, count }, other) => {
    const key = other === undefined ? kind : `${kind} ${other}`
    const { items } = counted.get(key) ?? counted.set(key, { kind, other, items: {} }).get(key)
    items[name] = (items[name] ?? 0) + count
  }

  player.tellActs = () => {
    const acts = [...counted.values()]
    counted = new Map()
    for (const { kind, other, items } of acts) player.emitEvent({ kind, detail: other === undefined ? { items } : { other, items } })
  }
  for (const end of ['rest', 'disconnected']) player.on(end, () => player.tellActs())
}
