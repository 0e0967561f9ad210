'use strict'
/** Puts agents into a region: a server-side player and the Mineflayer bot that is its mind. */
const { connect } = require('../net/transport')
const { agentUuid, INJECTION_MS, startBot } = require('../bots/bot')

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
      // A client answers being placed with "not on the ground".
      bot.entity.onGround = state.on_ground
      player.onGround = state.on_ground
      bot.physicsEnabled = true
      region.bodies.set(agent, { bot, player })
    }
  }

  start (region, agent, state) {
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
    player.setPossessions({ inventory: state.inventory, equipment: state.equipment })
    player.updateHealth(state.health)
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

module.exports = { Bodies }
