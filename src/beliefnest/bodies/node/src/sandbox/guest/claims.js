'use strict'
/**
 * What programs make claims with. A claim is plain data; whoever takes it checks it.
 * Runs inside QuickJS: the function is handed over as text and must not refer to anything outside it.
 */
module.exports = function defineClaims (env) {
  env.claims = {
    located: (item, place) => ({ kind: 'located', item, place }),
    absent: (item, place) => ({ kind: 'absent', item, place }),
    positionOf: (agent, place) => ({ kind: 'position', agent, place }),
    blockAt: (place, state) => ({ kind: 'block', place, state })
  }
}
