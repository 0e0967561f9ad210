'use strict'

const { FACTS, pressedBy } = require('./lib/circuits')

const PLAYER = { halfWidth: 0.3, height: 1.8 }
const SPECTATOR = 3
const ITEM = { halfWidth: 0.125, height: 0.25 }

/** Add pressure plates, which agents press by standing on them; wooden ones are pressed by dropped items, too. */
module.exports.server = (serv) => {
  /** Return the cells whose plates a body may touch. */
  function cellsOf (position, { halfWidth }) {
    const { x, y, z } = position
    const span = (value) => [...new Set([Math.floor(value - halfWidth), Math.floor(value + halfWidth)])]
    return span(x).flatMap((i) => span(z).map((k) => position.clone().set(i, Math.floor(y), k)))
  }

  function touches (place, position, { halfWidth, height }) {
    const { plateInset, plateHeight } = FACTS
    const overlaps = (low, value) =>
      value + halfWidth > low + plateInset && value - halfWidth < low + 1 - plateInset
    return overlaps(place.x, position.x) && overlaps(place.z, position.z) &&
      position.y < place.y + plateHeight && position.y + height > place.y
  }

  const bodies = () => [
    ...serv.players.filter(({ gameMode }) => gameMode !== SPECTATOR).map(({ position }) => ({ position, size: PLAYER, by: ['living', 'all'] })),
    ...serv.itemEntities(() => true).map(({ position }) => ({ position, size: ITEM, by: ['all'] })),
  ]

  const isPressed = (place, by) => bodies().some((body) =>
    body.by.includes(by) && touches(place, body.position, body.size))

  function press (place, powered) {
    const block = serv.blocks.at(place)
    serv.blocks.set(place, serv.blocks.stateWith(block, { powered }))
  }

  /** Look who stands on a pressed plate; it comes up if nobody does. */
  function look (place) {
    const block = serv.blocks.at(place)
    const by = pressedBy(block)
    if (by === null || !block.properties.powered) return
    if (isPressed(place, by)) serv.after(FACTS.plateLooks, place, 'look')
    else press(place, false)
  }
  serv.onDue('look', look)

  serv.onTick((within) => {
    for (const { position, size, by } of bodies()) {
      if (!within(position)) continue
      for (const place of cellsOf(position, size)) {
        const block = serv.blocks.at(place)
        if (!by.includes(pressedBy(block)) || !touches(place, position, size)) continue
        if (!block.properties.powered) press(place, true)
        if (!serv.isDueAt(place, 'look')) serv.after(FACTS.plateLooks, place, 'look')
      }
    }
  })
}
