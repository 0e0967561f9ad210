'use strict'
/** Mineflayer bot with a pathfinder, at the client's end of a connection. */
const { createHash } = require('node:crypto')
const mineflayer = require('mineflayer')
const { pathfinder } = require('mineflayer-pathfinder')
const { equipHeldSlot } = require('./equipping')
const { chargePathfinder } = require('./pathing')
const { refuseUnreachable } = require('./reaching')

// Mineflayer injects its plugins in a timer, which Node fires after this time.
const INJECTION_MS = 1

// Vertical speed of a standing player after gravity: (0 - 0.08) * 0.98 per tick.
const STANDING_VELOCITY = -0.0784

/** Clock without charges. Searches for paths are then limited only by their number of nodes. */
const REAL_TIME = {}

const CONTROLS = ['forward', 'back', 'left', 'right', 'jump', 'sprint', 'sneak']

/**
 * Start a bot. It is usable after `INJECTION_MS` of virtual time.
 * @param {object} client a connection's client end
 * @param {{charge?: (ms: number) => void}} clock charges for path searches; without `charge` time is real
 */
function startBot (client, clock) {
  const bot = mineflayer.createBot({
    client,
    username: client.username,
    version: client.version,
    hideErrors: true,
    logErrors: false,
    brand: 'vanilla'
  })
  bot.setMaxListeners(0)
  keepSecond(bot, client)
  bot.once('inject_allowed', () => {
    bot.loadPlugin(pathfinder)
    chargePathfinder(bot, clock)
    equipHeldSlot(bot)
    refuseUnreachable(bot)
  })
  return bot
}

/**
 * Add `beginSecond()` to a bot, which sets the time of the bot's last position packet to now. A standing bot sends its
 * position, and emits `move`, one second after that time. Mineflayer keeps the time in the packet object that it sent
 * last, and no snapshot contains it.
 */
function keepSecond (bot, client) {
  const { write } = client
  let lastLook = { time: 0 }
  client.write = (name, params) => {
    if (name === 'position_look') lastLook = params
    return write.call(client, name, params)
  }
  bot.beginSecond = () => { lastLook.time = performance.now() }
}

/**
 * Make a bot stand still and end its activities: path, digging, controls, window. Also reset its pathfinder's
 * settings.
 * @returns {string[]} the activities that were ended
 */
function stopBot (bot) {
  const doing = []
  if (bot.pathfinder.goal) doing.push('a walk')
  else if (CONTROLS.some(control => bot.getControlState(control))) doing.push('a movement')
  if (bot.targetDigBlock) doing.push('digging')
  if (bot.currentWindow) doing.push('an open window')
  // A connection to a server elsewhere has no limit on packets.
  if (bot._client.beyond) bot._client.beyond(() => letGo(bot))
  else letGo(bot)
  return doing
}

function letGo (bot) {
  bot.pathfinder.setGoal(null)
  bot.pathfinder.reset()
  if (bot.targetDigBlock) bot.stopDigging()
  bot.clearControlStates()
  bot.jumpQueued = false
  if (bot.currentWindow) bot.closeWindow(bot.currentWindow)
  bot.deactivateItem()
}

/** Set a placed bot on the ground, or let it fall: a client assumes that a placed player is in the air. */
function ground (bot, onGround) {
  bot.entity.onGround = onGround
  if (onGround) bot.entity.velocity.y = STANDING_VELOCITY
}

/** Return a player id (UUID) that depends only on the agent's name. @returns {string} */
function agentUuid (agent) {
  const bytes = createHash('md5').update(`OfflinePlayer:${agent}`).digest()
  bytes[6] = (bytes[6] & 0x0f) | 0x30
  bytes[8] = (bytes[8] & 0x3f) | 0x80
  const hex = bytes.toString('hex')
  return [hex.slice(0, 8), hex.slice(8, 12), hex.slice(12, 16), hex.slice(16, 20), hex.slice(20)].join('-')
}

module.exports = { agentUuid, ground, INJECTION_MS, REAL_TIME, startBot, stopBot }
