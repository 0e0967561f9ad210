'use strict'
/** Windows of chests and barrels with 27 slots each; two chests may share one window. */

const HALF = 27
const WINDOW_9X3 = 2
const WINDOW_9X6 = 5
const TITLES = { chest: 'Chest', trapped_chest: 'Trapped Chest', barrel: 'Barrel' }

/** Return type and title of the window of `count` such blocks, as a client shows it. */
function windowOf (name, count) {
  return count === 1
    ? { type: WINDOW_9X3, title: TITLES[name] ?? name }
    : { type: WINDOW_9X6, title: `Large ${TITLES[name] ?? name}` }
}

module.exports = { HALF, TITLES, windowOf }
