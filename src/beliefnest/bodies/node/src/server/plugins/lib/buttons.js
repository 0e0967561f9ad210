'use strict'

const STONE = /^(stone|polished_blackstone)_button$/
const STONE_TICKS = 20
const WOODEN_TICKS = 30

/** @returns {number} ticks after which a pressed button of that name comes out again; 0: it is no button */
function pressedTicks (name) {
  if (!name.endsWith('_button')) return 0
  return STONE.test(name) ? STONE_TICKS : WOODEN_TICKS
}

module.exports = { pressedTicks }
