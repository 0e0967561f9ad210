'use strict'
/** What is the case in a region, as the channel says it: read from the server, never from bots. */
const { toStep } = require('../steps')

const DECIMALS = 1e6

/** @returns {number} rounded as the channel asks for; never -0, which msgpack would keep */
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

/** @returns {Array} [x, y, z, items or null] of containers that changed since the last call */
function changedContainers (serv, region) {
  return serv.containers.drainChanges(position => region.contains(position)).map(position => {
    const items = serv.containers.get(position)
    return [...region.toScenario(position), items === null ? null : sorted(items)]
  })
}

/** @returns {Array} [x, y, z, items] of all containers in the box */
function containerStates (serv, region) {
  return serv.containers.positions(position => region.contains(position)).map(position =>
    [...region.toScenario(position), sorted(serv.containers.get(position))])
}

/** @returns {Array} [x, y, z, text] of all signs in the box that are written on */
function signStates (serv, region) {
  return serv.signs.positions(position => region.contains(position)).map(position =>
    [...region.toScenario(position), serv.signs.get(position)])
}

/** @returns {object} agents of the active region by name */
function agentStates (serv, region) {
  return Object.fromEntries(serv.players.map(player => [player.agent, agentState(region, player)]))
}

/** @returns {object} dropped items of the active region by number */
function itemStates (serv, region) {
  const items = {}
  for (const { id, item, position } of serv.itemEntities(place => region.contains(place))) {
    items[id] = { name: item.name, count: item.count, position: region.toScenario(position).map(rounded) }
  }
  return items
}

/** @returns {object} what a Recorder asks of a server in this process */
function factsOf (serv, region) {
  return {
    agents: () => agentStates(serv, region),
    items: () => itemStates(serv, region),
    changedContainers: () => changedContainers(serv, region),
    blockText: state => serv.blocks.text(state),
    signText: position => serv.signs.get(region.toServer(position))
  }
}

/** Put what lies in a region exactly where the channel says it does. */
function settleItems (serv, region) {
  for (const entity of serv.itemEntities(place => region.contains(place))) {
    const [x, y, z] = region.toScenario(entity.position).map(rounded).map(toStep)
    serv.placeItem(entity, region.toServer([x, y, z]))
  }
}

module.exports = { agentState, agentStates, containerStates, factsOf, itemStates, rounded, settleItems, signStates, sorted }
