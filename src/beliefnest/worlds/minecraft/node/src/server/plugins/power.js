'use strict'

const { FACES } = require('./lib/directions')
const { holderOf } = require('./lib/holders')

const SOURCE = /^lever$|_button$/
const OPENS = /_door$|_trapdoor$|_fence_gate$/
const LAMP = 'redstone_lamp'

/**
 * Add power: levers and buttons power the blocks beside them and beside the block they are attached to. Doors,
 * trapdoors and gates (iron ones too) open, lamps light. There is no other redstone.
 */
module.exports.server = (serv) => {
  const around = (position) => FACES.map((face) => position.plus(face))

  function isOn (position) {
    const { name, properties } = serv.blocks.at(position)
    return SOURCE.test(name) && properties.powered
  }

  /** Return true if a lever or button that is on is attached to the block at a position. */
  const holdsPower = (position) => serv.blocks.at(position).solid && around(position).some((place) =>
    isOn(place) && place.plus(holderOf(serv.blocks.at(place))).equals(position))

  const isPowered = (position) => around(position).some((place) => isOn(place) || holdsPower(place))

  function partsOf (position, block) {
    if (!block.name.endsWith('_door')) return [position]
    return [position, position.offset(0, block.properties.half === 'lower' ? 1 : -1, 0)]
      .filter((part) => serv.blocks.at(part).name === block.name)
  }

  function update (position, player) {
    const block = serv.blocks.at(position)
    if (!OPENS.test(block.name) && block.name !== LAMP) return
    const parts = partsOf(position, block)
    const powered = parts.some(isPowered)
    const change = block.name === LAMP ? { lit: powered } : { powered, open: powered }
    const [key] = Object.keys(change)
    if (block.properties[key] === powered) return
    for (const part of parts) serv.blocks.set(part, serv.blocks.stateWith(serv.blocks.at(part), change), player)
  }

  serv.blocks.on('update', ({ position, before, after, player }) => {
    const source = [before, after].map(serv.blocks.describe).find(({ name }) => SOURCE.test(name))
    if (!source) return
    const places = [...around(position), ...around(position.plus(holderOf(source)))]
    places.forEach((place) => update(place, player))
  })
}
