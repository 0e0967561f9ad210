'use strict'

const { PlayerWindows } = require('./lib/playerWindows')

/** Windows: the server alone decides what a click does (see lib/clicks.js, lib/playerWindows.js). */
module.exports.server = (serv) => {
  serv.Item = require('prismarine-item')(serv.registry)
}

module.exports.player = (player, serv) => {
  const windows = new PlayerWindows(player, serv)
  player.windows = windows

  /** To be called after the slots of the inventory were changed. */
  player.inventoryChanged = () => {
    windows.sync()
    player.refreshEquipment()
  }
  player.inventory.on('updateSlot', () => player.inventoryChanged())

  player.on('rest', () => windows.rest())
  player._client.on('window_click', (packet) => windows.click(packet))
  player._client.on('close_window', ({ windowId }) => {
    if (windowId === windows.current.id) windows.close()
  })
}
