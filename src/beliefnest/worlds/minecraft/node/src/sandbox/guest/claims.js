'use strict'
/**
 * Functions with which programs make claims. A claim is plain data; its receiver checks it.
 *
 * The function runs inside QuickJS: it is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineClaims (env) {
  env.claims = {
    located: (item, place) => ({ kind: 'located', item, place }),
    absent: (item, place) => ({ kind: 'absent', item, place }),
    positionOf: (agent, place) => ({ kind: 'position', agent, place }),
    blockAt: (place, state) => ({ kind: 'block', place, state })
  }
}
