'use strict'
/** What agent programs find in scope besides `bot`. */
const { Vec3 } = require('vec3')
const { goals } = require('mineflayer-pathfinder')
const { bindSkills } = require('../../../programs/skills')

/**
 * @param {object} bot
 * @param {(event: {kind: string, detail: object}) => void} emit hears what the skills report
 * @param {AbortSignal} signal aborted when the program has ended
 * @param {import('./memory').Memory | null} [memory] remembers what it calls
 * @param {(number: number, signal?: AbortSignal) => Promise<void>} [wait] resolves after so many ticks of the world
 * @returns {object} by name
 */
function scopeOf (bot, emit, signal, memory = null, wait = undefined) {
  return { ...bindSkills({ bot, emit, Vec3, goals, signal, memory, wait }), Vec3, goals, mcData: bot.registry }
}

module.exports = { scopeOf }
