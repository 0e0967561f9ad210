'use strict'
/** How an agent as the channel describes it becomes a player of a server in this process. */

/**
 * Let a player of the active region join, where and as the agent is.
 * @param {object} serv
 * @param {import('./region').Region} region
 * @param {object} end the server's end of its connection
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

/** Show a player who has joined the world and those who are there. */
function showWorld (player, columns) {
  player.sendWorld(columns)
  player.meet()
  player.emit('connected')
}

module.exports = { join, showWorld }
