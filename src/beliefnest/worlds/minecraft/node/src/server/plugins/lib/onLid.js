'use strict'

const { conducts } = require('./circuits')
const { halvesAt } = require('./doubleChest')

const WITH_LIDS = ['chest', 'trapped_chest']

/**
 * Return the block that keeps a chest shut: one that carries power, on the lid of either half. The scripted world has
 * the same rule in worlds/scripted/skills.py.
 * @param {(position: object) => object} at returns the block at a position, as `blockStates().describe` does
 * @param {object} position of any block
 * @returns {object | undefined}
 */
function onLid (at, position) {
  if (!WITH_LIDS.includes(at(position).name)) return undefined
  return halvesAt(at, position).map((half) => at(half.offset(0, 1, 0))).find(conducts)
}

module.exports = { onLid }
