'use strict'

const STONE = /^(stone|polished_blackstone)_button$/
const STONE_TICKS = 20
const WOODEN_TICKS = 30

/** Return the number of ticks for which a button of that name stays pressed; 0 for other blocks. @returns {number} */
function pressedTicks (name) {
  if (!name.endsWith('_button')) return 0
  return STONE.test(name) ? STONE_TICKS : WOODEN_TICKS
}

module.exports = { pressedTicks }
