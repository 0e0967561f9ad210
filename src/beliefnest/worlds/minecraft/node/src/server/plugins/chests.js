'use strict'

const { cell, containerMenu } = require('./lib/menus')
const { halvesAt, partnerOf } = require('./lib/doubleChest')
const { HALF, TITLES, windowOf } = require('./lib/chestWindows')
const { onLid } = require('./lib/onLid')

const LID_ACTION = 1
/** Game mode of players whose looking does not open a lid. */
const SPECTATOR = 3

/** Show whether anybody looks into the container. */
function showLid (serv, position) {
  const block = serv.blocks.at(position)
  const count = serv.containers.viewers(position).filter(({ gameMode }) => gameMode !== SPECTATOR).length
  if (block.name === 'barrel') {
    serv.blocks.set(position, serv.blocks.stateWith(block, { open: count > 0 }))
    return
  }
  serv._writeAll('block_action', {
    location: position, byte1: LID_ACTION, byte2: count, blockId: block.type,
  })
}

/** Add chests, double chests, trapped chests and barrels: opening, moving items, lids. */
module.exports.server = (serv) => {
  Object.keys(TITLES).forEach((name) => serv.containers.define(name, HALF))

  function open ({ player, position, block }) {
    const positions = halvesAt(serv.blocks.at, position)
    if (onLid(serv.blocks.at, position)) return true
    const cells = positions.flatMap((half) => {
      const slots = serv.containers.slots(half)
      return slots.map((_, i) => cell(slots, i))
    })
    player.lookInto({
      ...windowOf(block.name, positions.length),
      positions,
      menu: containerMenu(cells, player),
      closed: () => positions.forEach((half) => showLid(serv, half)),
    })
    positions.forEach((half) => showLid(serv, half))
    return true
  }
  Object.keys(TITLES).forEach((name) => serv.onInteraction(name, open))

  /** Turn the remaining half of a double chest into a single chest. */
  serv.blocks.on('update', ({ position, before, after }) => {
    const old = serv.blocks.describe(before)
    const other = TITLES[old.name] && partnerOf(position, old)
    if (!other || serv.blocks.describe(after).name === old.name) return
    const half = serv.blocks.at(other)
    if (half.name === old.name) serv.blocks.set(other, serv.blocks.stateWith(half, { type: 'single' }))
  })
}
