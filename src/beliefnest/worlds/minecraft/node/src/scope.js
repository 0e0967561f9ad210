'use strict'
/** Scope of agent programs, besides `bot`. */
const { Vec3 } = require('vec3')
const { goals } = require('mineflayer-pathfinder')
const { bindSkills } = require('../../../../skills/code')

/**
 * Return the scope of a bot's program.
 * @param {object} bot
 * @param {(event: {kind: string, detail: object}) => void} emit called with the events of skills
 * @param {AbortSignal} signal aborted when the program has ended
 * @param {import('./memory').Memory | null} [memory] records the program's calls
 * @param {(number: number, signal?: AbortSignal) => Promise<void>} [wait] resolves after `number` ticks of the world
 * @returns {object} values by name
 */
function scopeOf (bot, emit, signal, memory = null, wait = undefined) {
  return { ...bindSkills({ bot, emit, Vec3, goals, signal, memory, wait }), Vec3, goals, mcData: bot.registry }
}

module.exports = { scopeOf }
