'use strict'

const { click } = require('./lib/clicks')
const { equal } = require('./lib/items')
const { INVENTORY_START, INVENTORY_END, inventoryMenu } = require('./lib/menus')

const LAST_WINDOW_ID = 100
const OWN_GRID_WIDTH = 2

/**
 * Windows. The server alone decides what a click does; a client is told every slot in which
 * it shows something else. `windows.shown` is what the client of a player shows in its own
 * window, `open.shown` in the opened one.
 */
module.exports.server = (serv) => {
  serv.Item = require('prismarine-item')(serv.registry)
}

function freshWindows () {
  return { cursor: null, stateId: 0, lastId: 0, shown: new Array(46).fill(null), open: null }
}

/** Own slots that the opened window does not show. */
function apart (slot) {
  return slot < INVENTORY_START || slot >= INVENTORY_END
}

module.exports.player = (player, serv) => {
  const { Item } = serv
  const client = player._client
  const windows = freshWindows()
  player.windows = windows
  const grid = serv.craftingGrid(player.inventory.slots, OWN_GRID_WIDTH)
  const own = {
    id: 0,
    shown: windows.shown,
    menu: inventoryMenu(player, grid),
    around: (run) => { run(); grid.refresh(); },
  }

  function sendSlot (window, slot) {
    const item = window.menu.get(slot)
    windows.stateId += 1
    window.shown[slot] = item
    client.write('set_slot', {
      windowId: window.id, stateId: windows.stateId, slot, item: Item.toNotch(item),
    })
  }

  function sendAll (window) {
    windows.stateId += 1
    for (let i = 0; i < window.menu.size; i++) window.shown[i] = window.menu.get(i)
    client.write('window_items', {
      windowId: window.id,
      stateId: windows.stateId,
      items: window.shown.map((item) => Item.toNotch(item)),
      carriedItem: Item.toNotch(windows.cursor),
    })
  }

  function sync (window, concerns = () => true) {
    for (let i = 0; i < window.menu.size; i++) {
      if (concerns(i) && !equal(window.shown[i], window.menu.get(i))) sendSlot(window, i)
    }
  }

  const current = () => windows.open ?? own

  /** Tells the client every slot in which it shows something else. */
  player.syncWindow = () => {
    if (windows.open) {
      sync(windows.open)
      sync(own, apart)
    } else {
      sync(own)
    }
  }
  player.sendWindow = () => sendAll(current())

  /** To be called after the slots of the inventory were changed. */
  player.inventoryChanged = () => {
    player.syncWindow()
    player.refreshEquipment()
  }
  player.inventory.on('updateSlot', () => player.inventoryChanged())

  /**
   * Opens `{type, title, menu, opened, around(run), leave(giveBack), closed()}` for the player.
   * `around` runs each click; `leave` gives back what lies in the window itself when it closes.
   */
  player.openWindow = (open) => {
    player.closeWindow()
    windows.lastId = (windows.lastId % LAST_WINDOW_ID) + 1
    windows.open = { ...open, id: windows.lastId, shown: new Array(open.menu.size).fill(null) }
    client.write('open_window', {
      windowId: windows.open.id,
      inventoryType: open.type,
      windowTitle: serv._createChatComponent(open.title).toNetworkFormat(),
    })
    sendAll(windows.open)
  }

  function returnItem (item) {
    const rest = player.storeItem(item)
    if (rest) serv.tossItem(player, rest)
  }

  function returnCursor () {
    const { cursor } = windows
    windows.cursor = null
    if (cursor) returnItem(cursor)
  }

  function emptyOwnGrid () {
    for (let slot = 1; slot <= 4; slot++) {
      const item = own.menu.get(slot)
      own.menu.set(slot, null)
      if (item) returnItem(item)
    }
    own.menu.set(0, null)
  }

  /** Ends the opened window on the server's side; what the cursor carries goes back. */
  player.closeWindow = () => {
    const { open } = windows
    windows.open = null
    if (open) {
      for (let i = INVENTORY_START; i < INVENTORY_END; i++) {
        windows.shown[i] = open.shown[open.menu.first + i - INVENTORY_START]
      }
      open.leave?.(returnItem)
    } else {
      emptyOwnGrid()
    }
    returnCursor()
    open?.closed?.()
    player.inventoryChanged()
  }
  /** Also tells the client, which did not ask for it. */
  player.forceCloseWindow = () => {
    if (!windows.open) return
    client.write('close_window', { windowId: windows.open.id })
    player.closeWindow()
  }

  function predict (window, packet) {
    for (const { location, item } of packet.changedSlots ?? []) {
      if (location >= 0 && location < window.menu.size) {
        window.shown[location] = Item.fromNotch(item)
      }
    }
  }

  /** The answer to a click; a client that has not seen the last changes is told again. */
  function answer (window, packet, stale) {
    if (!equal(Item.fromNotch(packet.cursorItem), windows.cursor)) {
      sendAll(window)
      return
    }
    if (stale) (packet.changedSlots ?? []).forEach(({ location }) => sendSlot(window, location))
    if (packet.slot >= 0 && packet.slot <= window.menu.craftSlots) sendSlot(window, 0)
    player.inventoryChanged()
  }

  function onClick (packet) {
    const window = current()
    if (packet.windowId !== window.id) return
    const stale = packet.stateId !== windows.stateId
    let outcome = null
    const run = () => { outcome = click(window.menu, windows.cursor, packet) }
    if (window.around) window.around(run)
    else run()
    predict(window, packet)
    if (!outcome) {
      sendAll(window)
      return
    }
    windows.cursor = outcome.cursor
    outcome.dropped.forEach((item) => serv.tossItem(player, item))
    answer(window, packet, stale)
  }

  client.on('window_click', onClick)
  client.on('close_window', ({ windowId }) => {
    if (windowId === (windows.open?.id ?? 0)) player.closeWindow()
  })
}
