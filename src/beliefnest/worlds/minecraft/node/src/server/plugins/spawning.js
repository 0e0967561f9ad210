'use strict'

/** Show entities to a player: players with their equipment, items with their kind. */
module.exports.player = (player) => {
  const client = player._client

  player.spawnEntity = (entity) => {
    const { x, y, z } = entity.position
    client.write('spawn_entity', {
      entityId: entity.id,
      objectUUID: entity.uuid,
      type: entity.entityType,
      x,
      y,
      z,
      pitch: entity.pitch,
      yaw: entity.yaw,
      headPitch: entity.yaw,
      objectData: 0,
      velocity: { x: 0, y: 0, z: 0 },
      appearance: entity.appearance,
    })
    entity.showMetadata?.(player)
    entity.showEquipment?.(player)
  }

  player.despawnEntities = (entities) => {
    if (entities.length) client.write('entity_destroy', { entityIds: entities.map(({ id }) => id) })
  }
}
