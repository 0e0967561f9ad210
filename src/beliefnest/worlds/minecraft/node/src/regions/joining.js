'use strict'
/** Joining of players: an agent as the channel describes it becomes a player of a server in this process. */

/**
 * Let a player join the active region, at the position and in the state of its agent.
 * @param {object} serv
 * @param {import('./region').Region} region
 * @param {object} end server's end of the player's connection
 * @param {object} state AGENT
 * @returns {object} the player
 */
function join (serv, region, end, state) {
  return serv.join(end, {
    position: region.toServer(state.position),
    yaw: state.yaw,
    pitch: state.pitch,
    onGround: state.on_ground,
    health: state.health,
    food: state.food
  })
}

/** Send the world to a player who has joined, and show that player and the others to each other. */
function showWorld (player, columns) {
  player.sendWorld(columns)
  player.meet()
  player.emit('connected')
}

module.exports = { join, showWorld }
