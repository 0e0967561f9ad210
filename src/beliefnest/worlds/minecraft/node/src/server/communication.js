'use strict'
/** Delivery of packets: everything reaches exactly the players of one's own region. */
const { ServerEnd } = require('../net/transport')

module.exports.name = 'communication'

module.exports.server = serv => {
  serv._writeArray = (name, packet, players, appearance) => {
    const ends = Array.from(players, player => player._client)
    ServerEnd.writeToAll(ends.filter(end => end instanceof ServerEnd), name, packet, appearance)
    for (const end of ends) if (!(end instanceof ServerEnd)) end.write(name, packet)
  }
  serv._writeAll = (name, packet) => serv._writeArray(name, packet, serv.players)
  serv.getNearby = ({ position, radius = Infinity }) => serv.players
    .filter(player => player.position.distanceTo(position) <= radius)
  serv.getNearbyEntities = ({ position, radius = Infinity }) => Object.values(serv.entities)
    .filter(entity => entity.position.distanceTo(position) <= radius)
  serv._writeNearby = (name, packet, place) => serv._writeArray(name, packet, serv.getNearby(place))
}

module.exports.entity = (entity, serv) => {
  const others = () => serv.players.filter(player => player !== entity)
  entity.getOtherPlayers = others
  entity.nearbyPlayers = others
  entity.getNearbyPlayers = others
  // A client without a tab list yet would not know whose entity it is shown.
  const hasList = other => other.type !== 'player' || other.listed
  entity.getNearby = () => Object.values(serv.entities).filter(other => other !== entity && hasList(other))
  entity._writeOthers = (name, packet) => serv._writeArray(name, packet, others())
  /** Send a packet that changes the appearance of this entity, which is a player. */
  entity.showMove = (name, packet) => serv._writeArray(name, packet, others(), entity.appearance)
  entity._writeOthersNearby = entity._writeOthers
  entity._writeNearby = (name, packet) => serv._writeAll(name, packet)
}

module.exports.player = player => {
  player.despawnEntities = entities => {
    if (entities.length === 0) return
    player._client.write('entity_destroy', { entityIds: entities.map(entity => entity.id) })
  }
}
