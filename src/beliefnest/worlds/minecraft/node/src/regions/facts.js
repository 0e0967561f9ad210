'use strict'
/** Present state of a region in the form of the channel, read from the server and never from bots. */
const { toStep } = require('../steps')

const DECIMALS = 1e6

/** Return a number rounded as the channel requires; never -0, which msgpack would keep. @returns {number} */
function rounded (value) {
  return Math.round(value * DECIMALS) / DECIMALS + 0
}

function agentState (region, player) {
  const { inventory, equipment } = player.possessions()
  return {
    position: region.toScenario(player.position).map(rounded),
    yaw: rounded(player.pose.yaw),
    pitch: rounded(player.pose.pitch),
    on_ground: player.onGround,
    equipment,
    inventory: sorted(inventory),
    health: player.health,
    food: player.food
  }
}

function sorted (items) {
  return Object.fromEntries(Object.entries(items).sort(([a], [b]) => (a < b ? -1 : 1)))
}

/** Return [x, y, z, items or null] of the containers that changed since the last call. @returns {Array} */
function changedContainers (serv, region) {
  return serv.containers.drainChanges(position => region.contains(position)).map(position => {
    const items = serv.containers.get(position)
    return [...region.toScenario(position), items === null ? null : sorted(items)]
  })
}

/** Return [x, y, z, items] of all containers in the box. @returns {Array} */
function containerStates (serv, region) {
  return serv.containers.positions(position => region.contains(position)).map(position =>
    [...region.toScenario(position), sorted(serv.containers.get(position))])
}

/** Return [x, y, z, text] of all signs in the box with a text. @returns {Array} */
function signStates (serv, region) {
  return serv.signs.positions(position => region.contains(position)).map(position =>
    [...region.toScenario(position), serv.signs.get(position)])
}

/** Return the agents of the active region by name. @returns {object} */
function agentStates (serv, region) {
  return Object.fromEntries(serv.players.map(player => [player.agent, agentState(region, player)]))
}

/** Return the dropped items of the active region by number. @returns {object} */
function itemStates (serv, region) {
  const items = {}
  for (const { id, item, position } of serv.itemEntities(place => region.contains(place))) {
    items[id] = { name: item.name, count: item.count, position: region.toScenario(position).map(rounded) }
  }
  return items
}

/** Return the functions with which a Recorder reads a server in this process. @returns {object} */
function factsOf (serv, region) {
  return {
    agents: () => agentStates(serv, region),
    items: () => itemStates(serv, region),
    changedContainers: () => changedContainers(serv, region),
    blockText: state => serv.blocks.text(state),
    signText: position => serv.signs.get(region.toServer(position))
  }
}

/** Put the dropped items of a region exactly at the positions that the channel reports. */
function settleItems (serv, region) {
  for (const entity of serv.itemEntities(place => region.contains(place))) {
    const [x, y, z] = region.toScenario(entity.position).map(rounded).map(toStep)
    serv.placeItem(entity, region.toServer([x, y, z]))
  }
}

module.exports = { agentState, agentStates, containerStates, factsOf, itemStates, rounded, settleItems, signStates, sorted }
