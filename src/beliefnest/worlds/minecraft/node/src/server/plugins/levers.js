'use strict'

const { listOf } = require('./lib/positions')
const { pressedTicks } = require('./lib/buttons')

/** Add levers, which stay as they are switched, and buttons, which come out again after some ticks. */
module.exports.server = (serv) => {
  function switchLever ({ player, position, block }) {
    const powered = !block.properties.powered
    serv.blocks.set(position, serv.blocks.stateWith(block, { powered }), player)
    player.emitEvent({ kind: 'use_lever', detail: { position: listOf(position), powered } })
    return true
  }
  serv.onInteraction('lever', switchLever)

  function release (position) {
    const block = serv.blocks.at(position)
    if (!block.name.endsWith('_button')) return
    serv.blocks.set(position, serv.blocks.stateWith(block, { powered: false }))
  }

  function push ({ player, position, block }) {
    if (block.properties.powered) return true
    serv.blocks.set(position, serv.blocks.stateWith(block, { powered: true }), player)
    player.emitEvent({ kind: 'press_button', detail: { position: listOf(position) } })
    serv.after(pressedTicks(block.name), position, 'release')
    return true
  }
  serv.onDue('release', release)
  for (const { name } of serv.registry.blocksArray) {
    if (pressedTicks(name) > 0) serv.onInteraction(name, push)
  }
}
