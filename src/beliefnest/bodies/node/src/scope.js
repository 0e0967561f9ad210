'use strict'
/** What agent programs find in scope besides `bot`. */
const { Vec3 } = require('vec3')
const { goals } = require('mineflayer-pathfinder')

/** @returns {object} by name */
function scopeOf (bot) {
  return { Vec3, goals, mcData: bot.registry }
}

module.exports = { scopeOf }
