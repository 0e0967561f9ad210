'use strict'
/** Agents of a region in real time: bots, people, and bots that stand in for people who are not there. */
const { Vec3 } = require('vec3')
const { stopBot } = require('../bots/bot')
const { Bodies } = require('../regions/bodies')
const { agentState } = require('../regions/facts')
const { join } = require('../regions/joining')

// How far from a wall somebody's middle is.
const HALF_WIDTH = 0.3

class LiveBodies extends Bodies {
  /** Let agents in; from the first moment they have what they are to have. */
  start (region, agent, state) {
    const started = super.start(region, agent, state)
    started.player.setPossessions(state)
    return started
  }

  /** End what a program left under way; a bot that still waits for something is made anew at once. */
  async rest (region, agent, clean) {
    const { bot, player } = region.bodies.get(agent)
    stopBot(bot)
    await this.clock.advance(0)
    player.emit('rest')
    await this.clock.advance(0)
    if (!clean) await this.standIn(region, agent)
  }

  /** Let bodies be: time goes on between the calls, too. */
  async stand () {
    return true
  }

  async finish () {}

  /** Put a new bot in the place of whoever an agent's body is: nobody sees a difference. */
  async standIn (region, agent) {
    const state = this.leave(region, agent)
    await this.add(region, { [agent]: state })
  }

  /** Put a person in the place of a bot. @returns {object} the player */
  seat (region, end) {
    const state = this.leave(region, end.username)
    const player = join(this.serv, region, end, state)
    player.setPossessions(state)
    this.letIn(region, player, state)
    region.bodies.set(end.username, { bot: nobody(), player })
    return player
  }

  /** @returns {object} AGENT, as it was */
  leave (region, agent) {
    const { player } = region.bodies.get(agent)
    const state = agentState(region, player)
    state.position = within(region.box, state.position)
    this.remove(region, agent)
    return state
  }
}

/** What a person has in place of a bot. */
function nobody () {
  return { entity: { onGround: true, velocity: new Vec3(0, 0, 0) }, removeAllListeners () {} }
}

/** A place of the box: where there is no longer anybody, a client may have said anything. */
function within ({ low, high }, [x, y, z]) {
  const clamp = (value, least, most) => Math.min(Math.max(value, least), most)
  return [
    clamp(x, low[0] + HALF_WIDTH, high[0] + 1 - HALF_WIDTH),
    clamp(y, low[1], high[1] + 1),
    clamp(z, low[2] + HALF_WIDTH, high[2] + 1 - HALF_WIDTH)
  ]
}

module.exports = { LiveBodies }
