'use strict'
/**
 * A pathfinder that plans over what an agent knows. What it does not know is free to whoever goes through it, and holds whoever
 * stands on it; the body still bumps into what is there, and what it was stuck at is gone round from then on.
 */
const { pathfinder } = require('mineflayer-pathfinder')
const { chargePathfinder } = require('../bots/pathing')

const PLANNED = 'planned blockUpdate'
const STUCK = 'stuck'
/** No block of any kind, to the sets of kinds that a search asks. */
const NO_KIND = 0
const JUST_ABOVE = 0.001

const cellOf = ({ x, y, z }) => [x, y, z].map(Math.floor).join()
const isSolid = block => block.boundingBox === 'block'

class Walker {
  /**
   * Give a view of a bot its pathfinder.
   * @param {object} view see view.js
   * @param {import('./knownWorld').KnownWorld} known
   * @param {import('../time/clock').Clock} clock
   */
  constructor (view, known, clock) {
    this.view = view
    this.known = known
    this.felt = new Set()
    this.path = []
    this.level = null
    this.floor = known.make(view.registry.blocksByName.stone.defaultState)
    const walker = Object.create(view)
    walker.blockAt = place => this.trodden(place)
    walker.on = (event, listener) => view.on(event === 'blockUpdate' ? PLANNED : event, listener)
    pathfinder(walker)
    chargePathfinder(walker, clock, (x, y, z, isBelow) => this.unknownAt(x, y, z, isBelow))
    view.pathfinder = walker.pathfinder
    view.on('path_update', ({ path }) => { this.path = path })
    view.on('path_reset', reason => this.feel(reason))
  }

  /** The height on which the agent stands, or stood last. */
  get ground () {
    const { onGround, position } = this.view.entity
    if (onGround || this.level === null) this.level = Math.floor(position.y + JUST_ABOVE)
    return this.level
  }

  /** A block as steps are tried out on it before they are made. */
  trodden (place) {
    const [x, y, z] = [place.x, place.y, place.z].map(Math.floor)
    if (!this.known.lacks(x, y, z)) return this.known.blockIn(x, y, z)
    if (y >= this.ground) return null
    return Object.assign(Object.create(this.floor), { position: place.floored() })
  }

  /**
   * What a search finds in a place nothing is known of, or where the body was stuck; undefined elsewhere.
   * @param {boolean} isBelow whether it is asked for as what lies below somebody's feet
   */
  unknownAt (x, y, z, isBelow) {
    const isFelt = this.felt.has([x, y, z].join())
    if (!isFelt && !this.known.lacks(x, y, z)) return undefined
    const position = this.view.entity.position.clone().set(x, y, z)
    return {
      position,
      type: NO_KIND,
      shapes: [],
      safe: !isBelow && !isFelt,
      physical: isBelow,
      height: isBelow ? y + 1 : y,
      liquid: false,
      climbable: false,
      replaceable: false,
      canFall: false,
      openable: false
    }
  }

  /** Let ways be looked for anew where what was learnt is not what they count on. */
  learn (before, after) {
    if (after === null) return
    const { position } = after
    if (before !== null) return this.view.emit(PLANNED, before, after)
    if (isSolid(after) !== position.y < this.ground) this.view.emit(PLANNED, { position, type: -1 }, after)
  }

  // The place that was to be stepped to, and the one above it, which a head would be in.
  feel (reason) {
    if (reason !== STUCK || this.path.length === 0) return
    const [next] = this.path
    this.felt.add(cellOf(next))
  }
}

module.exports = { Walker }
