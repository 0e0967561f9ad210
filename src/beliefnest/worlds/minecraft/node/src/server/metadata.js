'use strict'
/** Entity metadata (an item's kind, sneaking), sent to the players of the region. */

module.exports.name = 'entities'

module.exports.entity = entity => {
  entity.sendMetadata = metadata => entity._writeOthersNearby('entity_metadata', {
    entityId: entity.id, metadata
  })
  entity.setAndUpdateMetadata = metadata => {
    entity.metadata = metadata
    entity.sendMetadata(metadata)
  }
}
