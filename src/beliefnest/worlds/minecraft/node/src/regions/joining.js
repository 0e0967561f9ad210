'use strict'
/** Joining of players: makes a player of the server in this process from an agent's state as sent over the channel. */

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
