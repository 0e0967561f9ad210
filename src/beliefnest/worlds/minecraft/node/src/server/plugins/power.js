'use strict'

const { FACTS, LAMP, WIRE, answerOf, conducts, otherHalfOf, sourceOf } = require('./lib/circuits')
const { Circuit, around } = require('./lib/circuit')

/**
 * Add power: levers, buttons, plates and blocks of redstone power the blocks beside them and beside the block they
 * are attached to. Wires carry power over 15 blocks. Doors, trapdoors and gates (iron ones too) open, lamps light.
 * There is no other redstone.
 */
module.exports.server = (serv) => {
  const at = (position) => serv.blocks.at(position)
  const answer = (block, powered) => answerOf(serv.registry, block, powered)
  const circuit = new Circuit(at)

  /** Return the positions of a block and of the other half of a door. */
  function partsOf (position, block) {
    const step = otherHalfOf(block)
    const other = position.offset(0, step, 0)
    return step !== 0 && at(other).name === block.name ? [position, other] : [position]
  }

  function respond (position, player) {
    const block = at(position)
    const parts = partsOf(position, block)
    const powered = parts.some((part) => circuit.isPowered(part))
    if (answer(block, powered) === null) return
    if (block.name === LAMP && !powered) {
      if (!serv.isDueAt(position, 'dim')) serv.after(FACTS.dims, position, 'dim')
      return
    }
    for (const part of parts) {
      const state = answer(at(part), powered)
      if (state !== null) serv.blocks.set(part, state, player)
    }
  }

  serv.onDue('dim', (position) => {
    const block = at(position)
    if (block.name === LAMP && block.properties.lit && !circuit.isPowered(position)) {
      serv.blocks.set(position, answer(block, false))
    }
  })

  /** Let wires and other blocks react to a change at a position. */
  function settle (position, player) {
    const wires = circuit.network(position)
    const levels = circuit.levels(wires)
    const changed = wires.filter((place) => at(place).properties.power !== levels.get(`${place}`))
    for (const place of changed) {
      const state = serv.blocks.state(WIRE, { ...circuit.connections(place), power: levels.get(`${place}`) })
      serv.blocks.put(place, state, player)
    }
    for (const place of around([position, ...changed])) respond(place, player)
  }

  const isPart = (block) => block.name === WIRE || sourceOf(block) !== null
  const responds = (block) => [true, false].some((powered) => answer(block, powered) !== null)

  serv.blocks.on('update', ({ position, before, after, player }) => {
    const [old, block] = [before, after].map(serv.blocks.describe)
    const isNew = old.name !== block.name && responds(block)
    if (isPart(old) || isPart(block) || isNew || conducts(old) !== conducts(block)) settle(position, player)
  })
}
