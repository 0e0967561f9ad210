'use strict'
/** Agents of a region: for each a player of the server and the Mineflayer bot that controls it. */
const { connect } = require('../net/transport')
const { BadRequest } = require('../channel/errors')
const { orBadRequest } = require('./changes')
const { agentState } = require('./facts')
const { join, showWorld } = require('./joining')
const { takeColumns } = require('../bots/columns')
const { shareAppearances } = require('../bots/others')
const { agentUuid, ground, INJECTION_MS, startBot, stopBot } = require('../bots/bot')

class Bodies {
  /**
   * @param {object} serv
   * @param {import('../time/clock').Clock} clock
   */
  constructor (serv, clock) {
    this.serv = serv
    this.clock = clock
    const ChatMessage = require('prismarine-chat')(serv.registry)
    this.Entity = require('prismarine-entity')(serv.registry)
    this.readChat = content => ChatMessage.fromNotch(content).json
  }

  /**
   * Let agents join the active region, all at the same time. This takes `INJECTION_MS`.
   * @param {import('./region').Region} region
   * @param {object} agents AGENT by name
   */
  async add (region, agents) {
    // Start ticks at full tick times, whenever an agent joined.
    this.clock.active.time -= INJECTION_MS
    const joining = inOrder(Object.entries(agents)).map(([agent, state]) => this.start(region, agent, state))
    await this.clock.advance(INJECTION_MS)
    for (const { player, state } of joining) this.letIn(region, player, state)
    await this.clock.advance(0)
    for (const { agent, bot, player, state } of joining) {
      stand(bot, player, state)
      bot.physicsEnabled = true
      region.bodies.set(agent, { bot, player })
    }
  }

  start (region, agent, state) {
    requireInside(region, agent, state.position)
    const { client, server } = connect({
      registry: this.serv.registry,
      mail: region.mail,
      translator: region.translator,
      username: agent,
      agent,
      uuid: agentUuid(agent),
      readChat: this.readChat
    })
    const bot = startBot(client, this.clock)
    shareAppearances(bot, client, this.Entity)
    takeColumns(bot, client, region.origin)
    bot.physicsEnabled = false
    return { agent, bot, player: join(this.serv, region, server, state), state }
  }

  letIn (region, player, state) {
    showWorld(player, region.columns)
    give(player, state)
  }

  /**
   * Set agents of the active region to the given states; null removes an agent.
   * @param {import('./region').Region} region
   * @param {object} agents AGENT or null by name
   */
  async apply (region, agents) {
    const present = Object.keys(agents).every(agent => (agents[agent] !== null) === region.bodies.has(agent))
    if (!present) return this.replace(region, agents)
    const changed = Object.entries(agents).filter(([, state]) => state !== null)
      .map(([agent, state]) => ({ ...region.bodies.get(agent), state }))
    for (const { player, state } of changed) {
      player.place(region.toServer(state.position), state.yaw, state.pitch)
      player.food = state.food
      give(player, state)
    }
    await this.clock.advance(0)
    for (const { bot, player, state } of changed) stand(bot, player, state)
  }

  // Let all agents join anew, because the order of joining decides who acts first in a tick.
  async replace (region, agents) {
    const states = Object.fromEntries(
      [...region.bodies].map(([agent, { player }]) => [agent, agentState(region, player)]))
    for (const agent of Object.keys(states)) this.remove(region, agent)
    // Drop the old bots' timers.
    region.context.timers.clear()
    region.mail.clear()
    const wanted = Object.entries({ ...states, ...agents }).filter(([, state]) => state !== null)
    await this.add(region, Object.fromEntries(wanted))
  }

  /**
   * Put agents exactly at the positions that the channel reports; standing agents stop gliding.
   * @param {import('./region').Region} region
   * @param {Iterable<string>} [agents] names; all agents by default
   */
  async settle (region, agents = region.bodies.keys()) {
    const settling = Array.from(agents, agent => {
      const { bot, player } = region.bodies.get(agent)
      const state = agentState(region, player)
      return { bot, player, state, velocity: bot.entity.velocity.clone() }
    })
    for (const { player, state } of settling) {
      if (state.on_ground) player.fallsFrom = null
      player.place(region.toServer(state.position), state.yaw, state.pitch)
    }
    await this.clock.advance(0)
    for (const { bot, player, state, velocity } of settling) {
      if (!state.on_ground) bot.entity.velocity.update(velocity)
      stand(bot, player, state)
      bot.beginSecond()
    }
  }

  /**
   * Bring an agent to a stand, unless it is in the air and has time to land.
   * @returns {Promise<boolean>} true if it stands
   */
  async stand (region, agent, hasTime) {
    if (hasTime && !region.bodies.get(agent).player.onGround) return false
    await this.settle(region, [agent])
    return true
  }

  /**
   * End the unfinished acts of an agent, so that snapshots need not contain them.
   * @param {boolean} clean whether no call of the program is still pending. A pending call would continue later;
   *   therefore the bot is then cut off, and only its fall still reaches the server
   */
  async rest (region, agent, clean) {
    const { bot, player } = region.bodies.get(agent)
    stopBot(bot)
    await this.clock.advance(0)
    player.emit('rest')
    await this.clock.advance(0)
    if (!clean) return this.cutOff(region, agent)
  }

  cutOff (region, agent) {
    region.bodies.get(agent).bot._client.cut()
  }

  /** End a run. If a bot was cut off from the server, replace all bots of the region. */
  async finish (region) {
    if (![...region.bodies.values()].some(({ bot }) => bot._client.isCut)) return
    const goesOn = this.serv.internalState(region)
    await this.replace(region, {})
    this.serv.restoreState(region, goesOn)
    await this.clock.advance(0)
  }

  /** Register the bots' part of the internal state; see server/plugins/internalState.js. */
  keepSpeeds () {
    this.serv.keeps('speeds', {
      save: region => inOrder([...region.bodies]).filter(([, { player }]) => !player.onGround)
        .map(([agent, { bot: { entity: { velocity: { x, y, z } } } }]) => [agent, x, y, z]),
      restore (rows, region) {
        const speeds = new Map(rows.map(([agent, ...speed]) => [agent, speed]))
        for (const [agent, { bot, player }] of region.bodies) {
          if (!player.onGround) bot.entity.velocity.set(...speeds.get(agent) ?? [0, 0, 0])
        }
      }
    })
  }

  /** Remove an agent from the active region. */
  remove (region, agent) {
    const { bot, player } = region.bodies.get(agent)
    region.bodies.delete(agent)
    player._client.end('removed')
    bot.removeAllListeners()
    this.serv.forgetPlayer?.(player.uuid)
  }
}

function inOrder (entries) {
  return entries.sort(([a], [b]) => (a < b ? -1 : 1))
}

function requireInside (region, agent, position) {
  // An agent on the topmost blocks has its feet above them, outside the box.
  const [x, y, z] = position.map(Math.floor)
  if (region.box.contains(x, Math.min(y, region.box.high[1]), z)) return
  throw new BadRequest(`agent ${agent} at (${position.join(', ')}) is outside the box of region ${region.name}`)
}

function give (player, { inventory, equipment, health }) {
  orBadRequest(() => player.setPossessions({ inventory, equipment }))
  player.updateHealth(health)
}

// Correct a client's own state: after being placed it assumes "not on the ground".
function stand (bot, player, { on_ground: onGround }) {
  ground(bot, onGround)
  player.onGround = onGround
}

module.exports = { Bodies }
