'use strict'

const { FACES } = require('./lib/directions')
const { holderOf } = require('./lib/holders')

/** Break blocks whose supporting block is gone. */
module.exports.server = (serv) => {
  function comeOff (position, player) {
    const block = serv.blocks.at(position)
    const holder = holderOf(block)
    if (!holder || serv.blocks.at(position.plus(holder)).solid) return
    serv.blocks.set(position, 0, player)
    const item = serv.registry.itemsByName[block.name.replace('wall_', '')]
    if (item) serv.popItem(position, new serv.Item(item.id, 1))
  }

  serv.blocks.on('update', ({ position, after, player }) => {
    if (!player || serv.blocks.describe(after).solid) return
    FACES.forEach((face) => comeOff(position.plus(face), player))
  })
}
