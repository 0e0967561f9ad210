'use strict'
/** A Mineflayer bot with pathfinder at the client's end of a connection. */
const { createHash } = require('node:crypto')
const mineflayer = require('mineflayer')
const { pathfinder } = require('mineflayer-pathfinder')
const { equipHeldSlot } = require('./equipping')
const { chargePathfinder } = require('./pathing')
const { refuseUnreachable } = require('./reaching')

// mineflayer injects its plugins in a timer of its own, which Node fires after this long.
const INJECTION_MS = 1

// What gravity leaves of the vertical speed of one who stands: (0 - 0.08) * 0.98 a tick.
const STANDING_VELOCITY = -0.0784

/** A clock that nobody has to pay: searches for paths are limited by the nodes they look at. */
const REAL_TIME = {}

const CONTROLS = ['forward', 'back', 'left', 'right', 'jump', 'sprint', 'sneak']

/**
 * Start a bot; it is usable `INJECTION_MS` of virtual time later.
 * @param {object} client a connection's client end
 * @param {{charge?: (ms: number) => void}} clock pays for searches for paths; without `charge` time is real
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
 * Give a bot `beginSecond()`. A bot that stands tells where it is, and emits `move`, a second after it last did so. It keeps
 * that time in the object that it hands over with each packet, and no snapshot has it.
 */
function keepSecond (bot, client) {
  const { write } = client
  let told = { time: 0 }
  client.write = (name, params) => {
    if (name === 'position_look') told = params
    return write.call(client, name, params)
  }
  bot.beginSecond = () => { told.time = performance.now() }
}

/**
 * Make a bot stand still and finish what it was doing: path, digging, controls, window; how it looks
 * for paths is as at first.
 * @returns {string[]} what it was doing
 */
function stopBot (bot) {
  const doing = []
  if (bot.pathfinder.goal) doing.push('a walk')
  else if (CONTROLS.some(control => bot.getControlState(control))) doing.push('a movement')
  if (bot.targetDigBlock) doing.push('digging')
  if (bot.currentWindow) doing.push('an open window')
  // A connection of the game's own has no such bound.
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

/** Let a bot that was put somewhere stand, or fall: a client takes who is placed for one in the air. */
function ground (bot, onGround) {
  bot.entity.onGround = onGround
  if (onGround) bot.entity.velocity.y = STANDING_VELOCITY
}

/** @returns {string} a player id (UUID) that depends on nothing but the agent's name */
function agentUuid (agent) {
  const bytes = createHash('md5').update(`OfflinePlayer:${agent}`).digest()
  bytes[6] = (bytes[6] & 0x0f) | 0x30
  bytes[8] = (bytes[8] & 0x3f) | 0x80
  const hex = bytes.toString('hex')
  return [hex.slice(0, 8), hex.slice(8, 12), hex.slice(12, 16), hex.slice(16, 20), hex.slice(20)].join('-')
}

module.exports = { agentUuid, ground, INJECTION_MS, REAL_TIME, startBot, stopBot }
