'use strict'
/** Puts agents into a region: a server-side player and the Mineflayer bot that is its mind. */
const { connect } = require('../net/transport')
const { BadRequest } = require('../channel/errors')
const { orBadRequest } = require('./changes')
const { agentState } = require('./facts')
const { agentUuid, INJECTION_MS, startBot } = require('../bots/bot')

// What gravity leaves of the vertical speed of one who stands: (0 - 0.08) * 0.98 a tick.
const STANDING_VELOCITY = -0.0784

class Bodies {
  /**
   * @param {object} serv
   * @param {import('../time/clock').Clock} clock
   */
  constructor (serv, clock) {
    this.serv = serv
    this.clock = clock
    const ChatMessage = require('prismarine-chat')(serv.registry)
    this.readChat = content => ChatMessage.fromNotch(content).json
  }

  /**
   * Lets agents into the active region, all at the same time; costs `INJECTION_MS`.
   * @param {import('./region').Region} region
   * @param {object} agents AGENT by name
   */
  async add (region, agents) {
    const joining = Object.entries(agents).map(([agent, state]) => this.start(region, agent, state))
    await this.clock.advance(INJECTION_MS)
    for (const { player, state } of joining) this.letIn(region, player, state)
    await this.clock.advance(0)
    for (const { agent, bot, player, state } of joining) {
      ground(bot, player, state)
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
    bot.physicsEnabled = false
    const player = this.serv.join(server, {
      position: region.toServer(state.position),
      yaw: state.yaw,
      pitch: state.pitch,
      onGround: state.on_ground,
      health: state.health,
      food: state.food
    })
    return { agent, bot, player, state }
  }

  letIn (region, player, state) {
    player.sendWorld(region.columns)
    player.meet()
    player.emit('connected')
    give(player, state)
  }

  /**
   * Makes agents of the active region as asked; null: not there.
   * @param {import('./region').Region} region
   * @param {object} agents AGENT or null by name
   */
  async apply (region, agents) {
    const joining = {}
    const staying = []
    for (const [agent, state] of Object.entries(agents)) {
      const body = region.bodies.get(agent)
      if (state === null && body !== undefined) this.remove(region, agent)
      else if (state !== null && body === undefined) joining[agent] = state
      else if (state !== null) staying.push({ ...body, state })
    }
    for (const { player, state } of staying) {
      player.place(region.toServer(state.position), state.yaw, state.pitch)
      player.food = state.food
      give(player, state)
    }
    if (Object.keys(joining).length > 0) await this.add(region, joining)
    await this.clock.advance(0)
    for (const { bot, player, state } of staying) ground(bot, player, state)
  }

  /** Puts standing agents exactly where the channel says they are; their bots stop gliding. */
  async settle (region) {
    const standing = [...region.bodies.values()]
      .filter(({ player }) => player.onGround)
      .map(({ bot, player }) => ({ bot, player, state: agentState(region, player) }))
    for (const { player, state } of standing) {
      player.place(region.toServer(state.position), state.yaw, state.pitch)
    }
    await this.clock.advance(0)
    for (const { bot, player, state } of standing) ground(bot, player, state)
  }

  /** Takes an agent out of the active region. */
  remove (region, agent) {
    const { bot, player } = region.bodies.get(agent)
    region.bodies.delete(agent)
    player._client.end('removed')
    bot.removeAllListeners()
    this.serv.forgetPlayer?.(player.uuid)
  }
}

function requireInside (region, agent, position) {
  // Whoever stands on the topmost blocks has its feet above them.
  const [x, y, z] = position.map(Math.floor)
  if (region.box.contains(x, Math.min(y, region.box.high[1]), z)) return
  throw new BadRequest(`agent ${agent} at (${position.join(', ')}) is outside the box of region ${region.name}`)
}

function give (player, { inventory, equipment, health }) {
  orBadRequest(() => player.setPossessions({ inventory, equipment }))
  player.updateHealth(health)
}

// A client answers being placed with "not on the ground".
function ground (bot, player, { on_ground: onGround }) {
  bot.entity.onGround = onGround
  if (onGround) bot.entity.velocity.y = STANDING_VELOCITY
  player.onGround = onGround
}

module.exports = { Bodies }
