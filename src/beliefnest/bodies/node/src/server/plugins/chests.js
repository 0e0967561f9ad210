'use strict'

const { cell, containerMenu } = require('./lib/menus')
const { createLedger } = require('./lib/ledger')
const { keyOf, listOf, vecOf } = require('./lib/positions')
const { vectorOf, clockwise, counterclockwise } = require('./lib/directions')

const HALF = 27
const WINDOW_9X3 = 2
const WINDOW_9X6 = 5
const TITLES = { chest: 'Chest', trapped_chest: 'Trapped Chest', barrel: 'Barrel' }
const LID_ACTION = 1

/** Where the other half of a double chest stands, by the state of one half; null for a single. */
function partnerOf (position, { properties }) {
  if (!properties.type || properties.type === 'single') return null
  const turn = properties.type === 'left' ? clockwise : counterclockwise
  return vecOf(position).plus(vectorOf(turn(properties.facing)))
}

const isFullCube = ({ shapes }) => shapes.length === 1 &&
  shapes[0].every((edge, i) => edge === (i < 3 ? 0 : 1))

/** Chests, double chests, trapped chests and barrels: opening, moving items, lids. */
module.exports.server = (serv) => {
  Object.keys(TITLES).forEach((name) => serv.containers.define(name, HALF))

  /** The halves of what opens at a position, the upper one of the window first. */
  function halves (position) {
    const block = serv.blocks.at(position)
    const other = partnerOf(position, block)
    if (!other || serv.blocks.at(other).name !== block.name) return [vecOf(position)]
    return block.properties.type === 'right' ? [vecOf(position), other] : [other, vecOf(position)]
  }

  function isBlocked (position, block) {
    const above = serv.blocks.at(position.offset(0, 1, 0))
    return block.name !== 'barrel' && isFullCube(above) && !above.transparent
  }

  function viewers (position) {
    return serv.players.filter((player) =>
      player.windows.open?.positions?.some((open) => keyOf(open) === keyOf(position))).length
  }

  function showLid (position) {
    const block = serv.blocks.at(position)
    const count = viewers(position)
    if (block.name === 'barrel') {
      serv.blocks.set(position, serv.blocks.stateWith(block, { open: count > 0 }))
      return
    }
    for (const player of serv.players) {
      player._client.write('block_action', {
        location: position, byte1: LID_ACTION, byte2: count, blockId: block.type,
      })
    }
  }

  function open ({ player, position, block }) {
    const parts = halves(position)
    if (parts.some((part) => isBlocked(part, block))) return true
    const ledger = createLedger(parts, serv.containers.slots)
    const cells = parts.flatMap((part) => {
      const slots = serv.containers.slots(part)
      return slots.map((_, i) => cell(slots, i))
    })
    player.openWindow({
      type: parts.length === 2 ? WINDOW_9X6 : WINDOW_9X3,
      title: parts.length === 2 ? `Large ${TITLES[block.name]}` : TITLES[block.name],
      positions: parts,
      menu: containerMenu(cells, player),
      around: (run) => ledger.record(run).forEach(serv.containers.touch),
      closed: () => parts.forEach(showLid),
    })
    player.ledgers.push({ ledger, isOpen: () => player.windows.open?.positions === parts })
    parts.forEach(showLid)
    const clickedFirst = [...parts].sort((a, b) => b.equals(position) - a.equals(position))
    for (const part of clickedFirst) player.emitEvent({ kind: 'open_container', detail: { position: listOf(part) } })
    return true
  }
  Object.keys(TITLES).forEach((name) => serv.onInteraction(name, open))

  serv.onTick(() => serv.players.forEach((player) => player.reportTransfers()))

  serv.blocks.on('change', ({ position, before, after }) => {
    const old = serv.blocks.describe(before)
    const other = TITLES[old.name] && partnerOf(position, old)
    if (!other || serv.blocks.describe(after).name === old.name) return
    const half = serv.blocks.at(other)
    if (half.name !== old.name) return
    serv.blocks.set(other, serv.blocks.stateWith(half, { type: 'single' }))
  })
}

module.exports.player = (player) => {
  player.ledgers = []

  /** Reports what was moved on balance, once nothing is between chest and inventory any more. */
  player.reportTransfers = () => {
    if (player.windows.cursor) return
    for (const { ledger } of player.ledgers) ledger.settle().forEach((fact) => player.emitEvent(fact))
    player.ledgers = player.ledgers.filter(({ isOpen }) => isOpen())
  }
  player.on('disconnected', () => player.reportTransfers())
}

module.exports.partnerOf = partnerOf
