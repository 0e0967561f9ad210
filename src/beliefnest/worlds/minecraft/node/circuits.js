'use strict'
// Facts about redstone power by block state, for worlds without a server. The facts are those of the server
// plugins (lib/circuits.js). world/circuits.py reads the file.

const { FACTS, answerOf, conducts, connects, otherHalfOf, pressedBy, sourceOf } = require('./src/server/plugins/lib/circuits')
const { blockStates } = require('./src/server/plugins/lib/states')

const FORMAT = 1

/** Return the facts by block state: lists of state ids, and lists of `[state id, value]`. @returns {object} */
function buildCircuits (version) {
  const registry = require('prismarine-registry')(version)
  const { describe } = blockStates(registry)
  const states = registry.blocksArray.flatMap(({ minStateId, maxStateId }) =>
    Array.from({ length: maxStateId - minStateId + 1 }, (_, index) => describe(minStateId + index)))
  const that = (holds) => states.filter(holds).map(({ stateId }) => stateId)
  const by = (value) => states.map((block) => [block.stateId, value(block)]).filter(([, number]) => number !== null)
  return {
    format: FORMAT,
    minecraft: version,
    facts: FACTS,
    conductors: that(conducts),
    connecting: that(connects),
    sources: by(sourceOf),
    powered: by((block) => answerOf(registry, block, true)),
    unpowered: by((block) => answerOf(registry, block, false)),
    halves: by((block) => otherHalfOf(block) || null),
    plates: by(pressedBy),
  }
}

module.exports = { buildCircuits }
