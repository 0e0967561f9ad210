'use strict'
/** What entities show of themselves (an item's kind, sneaking) to the players of the region. */

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
