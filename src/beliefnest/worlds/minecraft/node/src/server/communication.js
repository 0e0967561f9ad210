'use strict'
/** Delivery of packets: everything reaches exactly the players of one's own region. */
const { ServerEnd } = require('../net/transport')

module.exports.name = 'communication'

/** Return true if the other end of a connection is in this process. */
const isNear = end => end instanceof ServerEnd

/** Send a packet to the players, except one, whose connection leads out of this process. */
function writeFar (name, packet, players, except) {
  for (const player of players) if (player !== except && !isNear(player._client)) player._client.write(name, packet)
}

module.exports.server = serv => {
  serv._writeArray = (name, packet, players) => {
    ServerEnd.writeToAll(players.map(player => player._client).filter(isNear), name, packet)
    writeFar(name, packet, players)
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
  /** Show a move of this entity to all other players. */
  entity.showMove = (name, packet) => {
    if (entity.appearance === undefined) return entity._writeOthers(name, packet)
    const { mail, translator } = serv.region
    mail.postMove(entity.appearance, entity._client.peer, name, translator.toClient(name, packet))
    writeFar(name, packet, serv.players, entity)
  }
  entity._writeOthersNearby = entity._writeOthers
  entity._writeNearby = (name, packet) => serv._writeAll(name, packet)
}

module.exports.player = player => {
  player.despawnEntities = entities => {
    if (entities.length === 0) return
    player._client.write('entity_destroy', { entityIds: entities.map(entity => entity.id) })
  }
}
