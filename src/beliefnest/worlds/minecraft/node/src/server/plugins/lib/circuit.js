'use strict'

const { Vec3 } = require('vec3')
const { FACES, vectorOf } = require('./directions')
const { FACTS, WIRE, conducts, connects, sourceOf } = require('./circuits')

const SIDES = ['north', 'south', 'west', 'east']
const OPPOSITE = { north: 'south', south: 'north', west: 'east', east: 'west' }
const UP = vectorOf('up')
const DOWN = vectorOf('down')
/** Steps to the cells that a source or wire may power, itself included. */
const NEAR = stepsWithin(2)

/**
 * Rules of redstone power: from sources, through blocks that carry it, along wires. The scripted world has the same
 * rules in worlds/scripted/circuit.py.
 */
class Circuit {
  /** @param {(position: Vec3) => object} at function that returns the block at a position */
  constructor (at) {
    this.at = at
  }

  isWire (position) {
    return this.at(position).name === WIRE
  }

  conducts (position) {
    return conducts(this.at(position))
  }

  /** Return true if a source is attached to the block at a position. */
  holdsSource (position) {
    return FACES.some((face) => {
      const place = position.plus(face)
      const strong = sourceOf(this.at(place))
      return strong !== null && strong >= 0 && place.plus(FACES[strong]).equals(position)
    })
  }

  /** Return the power that sources give to a wire at a position: all or nothing. */
  powerFrom (position) {
    return FACES.some((face) => {
      const place = position.plus(face)
      return sourceOf(this.at(place)) !== null || (this.conducts(place) && this.holdsSource(place))
    }) ? FACTS.range : 0
  }

  /** Return the positions of the wires from which a wire gets power. */
  feeders (position) {
    const covered = this.conducts(position.plus(UP))
    return SIDES.flatMap((side) => {
      const beside = position.plus(vectorOf(side))
      const [above, below] = [beside.plus(UP), beside.plus(DOWN)]
      if (this.isWire(beside)) return [beside]
      if (!this.conducts(beside)) return this.isWire(below) ? [below] : []
      return !covered && this.isWire(above) ? [above] : []
    })
  }

  /** Return how a wire connects to a side: `none`, `side` or `up`. */
  connection (position, side) {
    const beside = position.plus(vectorOf(side))
    const open = !this.conducts(position.plus(UP))
    if (open && this.isWire(beside.plus(UP)) && this.at(beside).solid) return 'up'
    const below = !this.conducts(beside) && this.isWire(beside.plus(DOWN))
    return connects(this.at(beside)) || below ? 'side' : 'none'
  }

  /** Return how a wire connects by side. The end of a line points on; a wire without neighbours keeps its form. */
  connections (position) {
    const shape = Object.fromEntries(SIDES.map((side) => [side, this.connection(position, side)]))
    const to = SIDES.filter((side) => shape[side] !== 'none')
    const { properties } = this.at(position)
    if (to.length === 1) shape[OPPOSITE[to[0]]] = 'side'
    if (to.length > 0 || SIDES.every((side) => properties[side] === 'none')) return shape
    return Object.fromEntries(SIDES.map((side) => [side, 'side']))
  }

  /** Return true if a wire with power at `place` powers the block at `position` beside it. */
  wirePowers (place, position) {
    const { name, properties } = this.at(place)
    if (name !== WIRE || properties.power === 0) return false
    const step = position.minus(place)
    if (step.y !== 0) return step.y < 0
    return this.connections(place)[SIDES.find((side) => vectorOf(side).equals(step))] !== 'none'
  }

  /** Return true if the block at a position has power, from a source, a wire or a block that carries it. */
  isPowered (position) {
    return FACES.some((face) => {
      const place = position.plus(face)
      if (sourceOf(this.at(place)) !== null || this.wirePowers(place, position)) return true
      return this.conducts(place) &&
        (this.holdsSource(place) || FACES.some((other) => this.wirePowers(place.plus(other), place)))
    })
  }

  /** Return the positions of wires near a position and of all wires that hang together with them, in order. */
  network (position) {
    const wires = new Map()
    const left = around([position]).filter((place) => this.isWire(place))
    while (left.length > 0) {
      const place = left.pop()
      if (wires.has(`${place}`)) continue
      wires.set(`${place}`, place)
      for (const side of SIDES) {
        const beside = place.plus(vectorOf(side))
        left.push(...[DOWN, new Vec3(0, 0, 0), UP].map((step) => beside.plus(step)).filter((next) => this.isWire(next)))
      }
    }
    return inOrder([...wires.values()])
  }

  /** Return the power of each wire of a network, by position as text. @returns {Map<string, number>} */
  levels (wires) {
    const levels = new Map(wires.map((place) => [`${place}`, this.powerFrom(place)]))
    const feeding = wires.map((place) => [`${place}`, this.feeders(place).map(String)])
    for (let changed = true; changed;) {
      changed = false
      for (const [place, from] of feeding) {
        const level = Math.max(...from.map((other) => levels.get(other) - 1), levels.get(place))
        changed ||= level !== levels.get(place)
        levels.set(place, level)
      }
    }
    return levels
  }
}

/** Return the positions within two steps of some positions, in order. */
function around (positions) {
  const places = new Map()
  for (const position of positions) {
    for (const step of NEAR) {
      const place = position.plus(step)
      places.set(`${place}`, place)
    }
  }
  return inOrder([...places.values()])
}

const inOrder = (positions) => positions.sort((a, b) => a.x - b.x || a.y - b.y || a.z - b.z)

function stepsWithin (distance) {
  const reach = Array.from({ length: 2 * distance + 1 }, (_, index) => index - distance)
  return reach.flatMap((x) => reach.flatMap((y) => reach.map((z) => new Vec3(x, y, z))))
    .filter(({ x, y, z }) => Math.abs(x) + Math.abs(y) + Math.abs(z) <= distance)
}

module.exports = { Circuit, around }
