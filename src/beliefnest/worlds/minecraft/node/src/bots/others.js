'use strict'
/** Other players, as a bot of this process sees them. */

const MOVED = 'entityMoved'

/**
 * Let the entities of other players take their pose from the appearance that all bots of the region share. A move is
 * then no work for a bot, unless something listens to its event `entityMoved`. Call this before the bot's plugins
 * are injected, so that Mineflayer finds the entities that are made here.
 * @param {object} bot
 * @param {import('../net/transport').ClientEnd} client the bot's end of its connection
 * @param {Function} Entity Mineflayer's class of entities
 */
function shareAppearances (bot, client, Entity) {
  client.on('spawn_entity', packet => {
    const { entityId, appearance } = packet
    if (appearance === undefined) return
    appearance.place(packet)
    bot.entities[entityId] ??= shownEntity(Entity, entityId, appearance)
  })
  bot.on('newListener', event => { if (event === MOVED) client.watch(true) })
  bot.on('removeListener', event => { if (event === MOVED) client.watch(bot.listenerCount(MOVED) > 0) })
}

/** Return an entity with the pose of an appearance; setting its angles has no effect. @returns {object} */
function shownEntity (Entity, id, appearance) {
  const entity = new Entity(id)
  entity.position = appearance.position
  for (const name of ['yaw', 'pitch', 'headYaw']) {
    Object.defineProperty(entity, name, { get: () => appearance[name], set () {}, enumerable: true })
  }
  return entity
}

module.exports = { shareAppearances }
