'use strict'
/** Changes of the active region to a given state. Only parts that differ are changed. */
const { isDeepStrictEqual } = require('node:util')
const { BadRequest } = require('../channel/errors')
const { itemStates, signStates } = require('./facts')

/**
 * Set blocks.
 * @param {Array} blocks [x, y, z, state]
 */
function applyBlocks (serv, region, blocks) {
  for (const [x, y, z, state] of blocks) {
    if (!region.box.contains(x, y, z)) {
      throw new BadRequest(`block (${x}, ${y}, ${z}) lies outside the box of region ${region.name}`)
    }
    serv.blocks.put(region.toServer([x, y, z]), state)
  }
}

/**
 * Set the contents of containers.
 * @param {Array} containers [x, y, z, items or null]; null means that there must be no container
 */
function applyContainers (serv, region, containers) {
  for (const [x, y, z, items] of containers) {
    const position = region.toServer([x, y, z])
    if (items !== null) {
      orBadRequest(() => serv.containers.set(position, items), `contents at (${x}, ${y}, ${z}): `)
    } else if (serv.containers.get(position) !== null) {
      throw new BadRequest(`a container stands at (${x}, ${y}, ${z}), but the request says that there is none; change its block`)
    }
  }
}

/**
 * Set the texts of signs.
 * @param {Array} signs [x, y, z, text] of all signs with a text
 */
function applySigns (serv, region, signs) {
  const wanted = new Map(signs.map(([x, y, z, text]) => [[x, y, z].join(), text]))
  for (const [x, y, z] of signStates(serv, region)) {
    if (!wanted.has([x, y, z].join())) serv.signs.set(region.toServer([x, y, z]), '')
  }
  for (const [x, y, z, text] of signs) {
    orBadRequest(() => serv.signs.set(region.toServer([x, y, z]), text), `sign at (${x}, ${y}, ${z}): `)
  }
}

/**
 * Set the dropped items.
 * @param {object} items all dropped items of the region by number
 */
function applyItems (serv, region, items) {
  for (const [id, state] of Object.entries(itemStates(serv, region))) {
    if (!isDeepStrictEqual(state, items[id])) serv.removeItem(id)
  }
  for (const [id, { name, count, position }] of Object.entries(items)) {
    if (serv.entities[id]?.item !== undefined) continue
    const data = serv.registry.itemsByName[name]
    if (data === undefined) throw new BadRequest(`there is no item called ${name}`)
    if (serv.entities[id] !== undefined) throw new BadRequest(`item ${id} has the entity number of an agent; give the item a higher number`)
    serv.dropItem(region.toServer(position), new serv.Item(data.id, count), { delay: 0, id: Number(id) })
  }
}

/** Run an action and turn a RangeError into a BadRequest; `where` names the place. */
function orBadRequest (action, where = '') {
  try {
    return action()
  } catch (error) {
    if (error instanceof RangeError) throw new BadRequest(where + error.message)
    throw error
  }
}

module.exports = { applyBlocks, applyContainers, applyItems, applySigns, orBadRequest }
