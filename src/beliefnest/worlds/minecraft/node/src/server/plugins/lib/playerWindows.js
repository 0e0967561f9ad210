'use strict'

const { click } = require('./clicks')
const { equal } = require('./items')
const { INVENTORY_START, INVENTORY_END, inventoryMenu, range } = require('./menus')

const LAST_WINDOW_ID = 100
const OWN_GRID_WIDTH = 2

/** Return true for slots of the player's own window that an opened window does not show. */
const isApart = (slot) => slot < INVENTORY_START || slot >= INVENTORY_END
const shows = (window, slot) => slot >= 0 && slot < window.menu.size

/**
 * Windows of one player: its own, and the one it has opened. `shown` of a window is the content that the player's
 * client shows; every slot that differs from it is sent to the client.
 */
class PlayerWindows {
  /**
   * @param {object} player player with `inventory`, `storeItem`, `inventoryChanged`, `canUse`
   * @param {object} serv
   */
  constructor (player, serv) {
    const grid = serv.craftingGrid(player.inventory.slots, OWN_GRID_WIDTH, player)
    const menu = inventoryMenu(player, grid)
    this.player = player
    this.serv = serv
    this.client = player._client
    this.own = { id: 0, menu, shown: new Array(menu.size).fill(null), around: (run) => { run(); grid.refresh() } }
    this.opened = null
    this.cursor = null
    this.stateId = 0
    this.lastId = 0
  }

  get current () { return this.opened ?? this.own }

  /** Return true if the opened window shows the block at a position. */
  looksInto (position) {
    return Boolean(this.opened?.positions?.some((other) => other.equals(position)))
  }

  sendSlot (window, slot) {
    const item = window.menu.get(slot)
    this.stateId += 1
    window.shown[slot] = item
    this.client.write('set_slot', {
      windowId: window.id, stateId: this.stateId, slot, item: this.serv.Item.toNotch(item),
    })
  }

  /** Send the client the whole current window. */
  sendAll () {
    const { current: window, serv: { Item } } = this
    this.stateId += 1
    for (let i = 0; i < window.menu.size; i++) window.shown[i] = window.menu.get(i)
    this.client.write('window_items', {
      windowId: window.id,
      stateId: this.stateId,
      items: window.shown.map((item) => Item.toNotch(item)),
      carriedItem: Item.toNotch(this.cursor),
    })
  }

  /** Send the client every slot whose shown content differs. */
  sync () {
    const { own, opened } = this
    if (opened) this.syncWindow(opened, () => true)
    this.syncWindow(own, opened ? isApart : () => true)
  }

  syncWindow (window, concerns) {
    for (let i = 0; i < window.menu.size; i++) {
      if (concerns(i) && !equal(window.shown[i], window.menu.get(i))) this.sendSlot(window, i)
    }
  }

  /**
   * Open a window.
   * @param {object} window `{type, title, menu, positions, around(run), leave(giveBack), closed()}`: `type` and
   *   `title` as the client shows them; `positions` of the blocks whose contents it shows, if any; `around` runs each
   *   click; when the window closes, `leave` returns the items in the window itself, and then `closed` is called
   */
  open (window) {
    this.close()
    this.lastId = (this.lastId % LAST_WINDOW_ID) + 1
    this.opened = { ...window, id: this.lastId, shown: new Array(window.menu.size).fill(null) }
    this.client.write('open_window', {
      windowId: this.lastId,
      inventoryType: window.type,
      windowTitle: this.serv._createChatComponent(window.title).toNetworkFormat(),
    })
    this.sendAll()
  }

  /** Close the opened window or the player's own one. Items on the cursor return to the inventory. */
  close () {
    const { opened, cursor } = this
    const giveBack = (item) => this.giveBack(item)
    this.opened = null
    this.cursor = null
    if (opened) this.takeOver(opened)
    else this.emptyGrid(giveBack)
    opened?.leave?.(giveBack)
    if (cursor) giveBack(cursor)
    opened?.closed?.()
    this.player.inventoryChanged()
  }

  /** Close all windows, because open windows are not part of the state that the next call starts from. */
  rest () {
    const { menu } = this.own
    const inGrid = () => range(0, menu.craftSlots + 1).some((slot) => menu.get(slot))
    if (this.opened) {
      this.forceClose()
    } else if (this.cursor || inGrid()) {
      this.close()
      this.sendAll()
    }
    this.lastId = 0
  }

  /** Close the opened window although the client did not ask for it. */
  forceClose () {
    if (!this.opened) return
    this.client.write('close_window', { windowId: this.opened.id })
    this.close()
    // A client that is told to close does not take over the window's content.
    this.sendAll()
  }

  /** Copy the shown inventory slots of the opened window to the player's own one. */
  takeOver ({ shown, menu }) {
    for (let i = INVENTORY_START; i < INVENTORY_END; i++) {
      this.own.shown[i] = shown[menu.first + i - INVENTORY_START]
    }
  }

  emptyGrid (giveBack) {
    const { menu } = this.own
    for (let slot = 1; slot <= menu.craftSlots; slot++) {
      const item = menu.get(slot)
      menu.set(slot, null)
      if (item) giveBack(item)
    }
    menu.set(0, null)
  }

  giveBack (item) {
    const rest = this.player.storeItem(item)
    if (rest) this.serv.tossItem(this.player, rest)
  }

  /** Handle a `window_click` of the client. */
  click (packet) {
    const window = this.current
    if (packet.windowId !== window.id) return
    if (window.positions && !window.positions.some((position) => this.player.canUse(position))) {
      this.forceClose()
      return
    }
    const stale = packet.stateId !== this.stateId
    let outcome = null
    const run = () => { outcome = click(window.menu, this.cursor, packet) }
    if (window.around) window.around(run)
    else run()
    this.predict(window, packet)
    if (!outcome) {
      this.sendAll()
      return
    }
    this.cursor = outcome.cursor
    outcome.dropped.forEach((item) => this.serv.tossItem(this.player, item))
    this.answer(window, packet, stale)
  }

  /** Record the slots that the client now shows according to its packet. */
  predict (window, { changedSlots = [] }) {
    for (const { location, item } of changedSlots) {
      if (shows(window, location)) window.shown[location] = this.serv.Item.fromNotch(item)
    }
  }

  /**
   * Answer a click. A client that has not received the last changes gets the whole window, as in the game: the changes
   * may have been undone by its prediction.
   */
  answer (window, { slot, cursorItem }, stale) {
    if (stale || !equal(this.serv.Item.fromNotch(cursorItem), this.cursor)) {
      this.sendAll()
      return
    }
    if (slot >= 0 && slot <= window.menu.craftSlots) this.sendSlot(window, 0)
    this.player.inventoryChanged()
  }
}

module.exports = { PlayerWindows }
