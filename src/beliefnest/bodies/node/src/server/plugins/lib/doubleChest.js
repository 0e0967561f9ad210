'use strict'

const { vecOf } = require('./positions')
const { vectorOf, clockwise, counterclockwise } = require('./directions')

/** Where the other half of a double chest stands, by the state of one half; null for a single. */
function partnerOf (position, { properties }) {
  if (!properties.type || properties.type === 'single') return null
  const turn = properties.type === 'left' ? clockwise : counterclockwise
  return vecOf(position).plus(vectorOf(turn(properties.facing)))
}

/**
 * The halves of what opens at a position, the upper one of the window first.
 * @param {(position: object) => {name: string, properties: object}} at the block at a position
 */
function halvesAt (at, position) {
  const block = at(position)
  const other = partnerOf(position, block)
  if (!other || at(other).name !== block.name) return [vecOf(position)]
  return block.properties.type === 'right' ? [vecOf(position), other] : [other, vecOf(position)]
}

module.exports = { halvesAt, partnerOf }
