'use strict'

const { PlayerWindows } = require('./lib/playerWindows')

/** Add windows: only the server decides the effect of a click (see lib/clicks.js, lib/playerWindows.js). */
module.exports.server = (serv) => {
  serv.Item = require('prismarine-item')(serv.registry)
}

module.exports.player = (player, serv) => {
  const windows = new PlayerWindows(player, serv)
  player.windows = windows

  /** Update windows and equipment; must be called after a change of the inventory's slots. */
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
