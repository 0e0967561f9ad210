'use strict'
/** Agents of a region in real time: bots, people, and bots that replace absent people. */
const { Vec3 } = require('vec3')
const { Bodies } = require('../regions/bodies')
const { agentState } = require('../regions/facts')
const { join } = require('../regions/joining')

// Distance from a wall to the middle of a player who touches it.
const HALF_WIDTH = 0.3

class LiveBodies extends Bodies {
  /** Start a bot. It has its items and its health from the first moment. */
  start (region, agent, state) {
    const started = super.start(region, agent, state)
    started.player.setPossessions(state)
    return started
  }

  /** Replace a bot that still waits for something at once. */
  cutOff (region, agent) {
    return this.standIn(region, agent)
  }

  /** Do nothing: time goes on between calls, so that bodies need not be brought to a stand. */
  async stand () {
    return true
  }

  async finish () {}

  /** Replace the player of an agent by a new bot. Nobody sees a difference. */
  async standIn (region, agent) {
    const state = this.leave(region, agent)
    await this.add(region, { [agent]: state })
  }

  /** Replace a bot by a person. @returns {object} the player */
  seat (region, end) {
    const state = this.leave(region, end.username)
    const player = join(this.serv, region, end, state)
    player.setPossessions(state)
    this.letIn(region, player, state)
    region.bodies.set(end.username, { bot: nobody(), player })
    return player
  }

  /** Remove an agent's player. @returns {object} its last AGENT */
  leave (region, agent) {
    const { player } = region.bodies.get(agent)
    const state = agentState(region, player)
    state.position = within(region.box, state.position)
    this.remove(region, agent)
    return state
  }
}

/** Return the object that stands for the bot of an agent that a person plays. */
function nobody () {
  return { entity: { onGround: true, velocity: new Vec3(0, 0, 0) }, removeAllListeners () {} }
}

/** Clamp a position to the box: the client of a removed player may have sent anything. */
function within ({ low, high }, [x, y, z]) {
  const clamp = (value, least, most) => Math.min(Math.max(value, least), most)
  return [
    clamp(x, low[0] + HALF_WIDTH, high[0] + 1 - HALF_WIDTH),
    clamp(y, low[1], high[1] + 1),
    clamp(z, low[2] + HALF_WIDTH, high[2] + 1 - HALF_WIDTH)
  ]
}

module.exports = { LiveBodies }
