'use strict'

const { vecOf } = require('./positions')
const { vectorOf, clockwise, counterclockwise } = require('./directions')

/** Return the position of the other half of a double chest, from the state of one half; null for a single chest. */
function partnerOf (position, { properties }) {
  if (!properties.type || properties.type === 'single') return null
  const turn = properties.type === 'left' ? clockwise : counterclockwise
  return vecOf(position).plus(vectorOf(turn(properties.facing)))
}

/**
 * Return the halves of the container at a position, the one in the window's upper part first: the right one, whose
 * position is that of the whole. A half without the other one is a container of its own.
 * @param {(position: object) => {name: string, properties: object}} at returns the block at a position
 */
function halvesAt (at, position) {
  const block = at(position)
  const other = partnerOf(position, block)
  if (!other || !belongTogether(block, at(other))) return [vecOf(position)]
  return block.properties.type === 'right' ? [vecOf(position), other] : [other, vecOf(position)]
}

function belongTogether (half, { name, properties }) {
  return name === half.name && properties.facing === half.properties.facing &&
    properties.type === (half.properties.type === 'left' ? 'right' : 'left')
}

module.exports = { halvesAt, partnerOf }
