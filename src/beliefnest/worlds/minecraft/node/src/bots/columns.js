'use strict'
/** Columns of blocks that a bot of this process is sent. */

/**
 * Let a bot take the column that is in a packet `map_chunk` itself, where Mineflayer would read its bytes. Call this
 * before the bot's plugins are injected.
 * @param {object} bot
 * @param {import('../net/transport').ClientEnd} client the bot's end of its connection
 */
function takeColumns (bot, client) {
  bot.once('inject_allowed', () => {
    client.removeAllListeners('map_chunk')
    client.on('map_chunk', ({ x, z, column }) => bot.world.setColumn(x, z, column))
  })
}

module.exports = { takeColumns }
