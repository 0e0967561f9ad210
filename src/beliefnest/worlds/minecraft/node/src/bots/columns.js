'use strict'
/** Columns of blocks of a bot of this process. */
const { CHUNK } = require('../regions/allotment')

/**
 * Let a bot take each column, when it first asks for it, from the source in the packet `ground`, where Mineflayer would
 * be sent all columns as bytes. Call this before the bot's plugins are injected.
 * @param {object} bot
 * @param {import('../net/transport').ClientEnd} client the bot's end of its connection
 * @param {{x: number, z: number}} origin server position of scenario (0, y, 0)
 */
function takeColumns (bot, client, origin) {
  bot.once('inject_allowed', () => {
    client.on('ground', ({ source, bottom }) => {
      bot.world.bottom = bottom
      bot.world.async.ground = (x, z) => source(x + origin.x / CHUNK, z + origin.z / CHUNK)
    })
  })
}

module.exports = { takeColumns }
