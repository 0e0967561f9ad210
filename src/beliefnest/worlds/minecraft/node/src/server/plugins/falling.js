'use strict'

const FALLS = /^(sand|red_sand|gravel|suspicious_sand|suspicious_gravel|anvil|chipped_anvil|damaged_anvil|dragon_egg|.*_concrete_powder)$/
const GIVES_WAY = /^(air|cave_air|void_air|water|lava|fire)$/
/** Number of ticks in which a block falls by one. */
const PACE = 2

/** Let unsupported sand and gravel fall, one block at a time. */
module.exports.server = (serv) => {
  function fall (position) {
    const block = serv.blocks.at(position)
    const below = position.offset(0, -1, 0)
    if (!FALLS.test(block.name) || !GIVES_WAY.test(serv.blocks.at(below).name)) return
    serv.blocks.set(position, 0)
    serv.blocks.set(below, block.stateId)
  }

  function check (position) {
    if (!FALLS.test(serv.blocks.at(position).name)) return
    if (!GIVES_WAY.test(serv.blocks.at(position.offset(0, -1, 0)).name)) return
    serv.after(PACE, position, 'fall')
  }
  serv.onDue('fall', fall)

  serv.blocks.on('update', ({ position }) => {
    check(position)
    check(position.offset(0, 1, 0))
  })
}
