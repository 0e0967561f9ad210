'use strict'

const { createLedger } = require('./lib/ledger')
const { listOf } = require('./lib/positions')

/**
 * Add windows of containers. Net moves of items are reported at the end of a tick in which no item is on its way
 * between container and inventory.
 */
module.exports.server = (serv) => {
  serv.onTick(() => serv.players.forEach((player) => player.reportTransfers()))
}

module.exports.player = (player, serv) => {
  const slots = (position) => serv.containers.allSlots(position)
  let ledgers = []

  /** Open a window on the container whose halves are at `window.positions` (see PlayerWindows.open). */
  player.lookInto = (window) => {
    const { positions } = window
    const ledger = createLedger([positions[0]], slots)
    const around = (run) => ledger.record(run).forEach((position) => serv.containers.touch(position))
    player.windows.open({ ...window, around })
    ledgers.push({ ledger, isOpen: () => player.windows.opened?.positions === positions })
    player.emitEvent({ kind: 'open_container', detail: { position: listOf(positions[0]) } })
  }

  player.reportTransfers = () => {
    if (player.windows.cursor) return
    for (const { ledger } of ledgers) ledger.settle().forEach((fact) => player.emitEvent(fact))
    ledgers = ledgers.filter(({ isOpen }) => isOpen())
  }
  for (const end of ['rest', 'disconnected']) player.on(end, () => player.reportTransfers())
}
