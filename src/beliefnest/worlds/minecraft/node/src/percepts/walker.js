'use strict'
/**
 * Pathfinder that plans over an agent's knowledge. It assumes that unknown blocks are passable to walk through and
 * solid to stand on. The body still collides with the real blocks; where it got stuck, later plans go around.
 */
const { pathfinder } = require('mineflayer-pathfinder')
const { chargePathfinder } = require('../bots/pathing')

const PLANNED = 'planned blockUpdate'
const STUCK = 'stuck'
/** Block type that is in none of the sets of types that a search uses. */
const NO_KIND = 0
const JUST_ABOVE = 0.001

const cellOf = ({ x, y, z }) => [x, y, z].map(Math.floor).join()
const isSolid = block => block.boundingBox === 'block'

class Walker {
  /**
   * Add a pathfinder to the view of a bot.
   * @param {object} view see view.js
   * @param {import('./knownWorld').KnownWorld} knownWorld
   * @param {import('../time/clock').Clock} clock
   */
  constructor (view, knownWorld, clock) {
    this.view = view
    this.knownWorld = knownWorld
    this.felt = new Set()
    this.path = []
    this.level = null
    this.floor = knownWorld.make(view.registry.blocksByName.stone.defaultState)
    const walker = Object.create(view)
    walker.blockAt = place => this.trodden(place)
    walker.on = (event, listener) => view.on(event === 'blockUpdate' ? PLANNED : event, listener)
    pathfinder(walker)
    chargePathfinder(walker, clock, (x, y, z, isBelow) => this.unknownAt(x, y, z, isBelow))
    view.pathfinder = walker.pathfinder
    view.on('path_update', ({ path }) => { this.path = path })
    view.on('path_reset', reason => this.feel(reason))
  }

  /** Return the height of the ground on which the agent stands or last stood. */
  get ground () {
    const { onGround, position } = this.view.entity
    if (onGround || this.level === null) this.level = Math.floor(position.y + JUST_ABOVE)
    return this.level
  }

  /** Return the block that physics assumes when the pathfinder simulates steps in advance. */
  trodden (place) {
    const [x, y, z] = [Math.floor(place.x), Math.floor(place.y), Math.floor(place.z)]
    if (!this.knownWorld.lacks(x, y, z)) return this.knownWorld.blockIn(x, y, z)
    if (y >= this.ground) return null
    return Object.assign(Object.create(this.floor), { position: place.floored() })
  }

  /**
   * Return the assumed block for a search at an unknown position, or where the body got stuck; undefined elsewhere.
   * @param {boolean} isBelow true if the search asks for the block below the feet
   */
  unknownAt (x, y, z, isBelow) {
    const isFelt = this.felt.size > 0 && this.felt.has([x, y, z].join())
    if (!isFelt && !this.knownWorld.lacks(x, y, z)) return undefined
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

  /** Replan if new knowledge contradicts the assumptions of the current path. */
  learn (before, after) {
    if (after === null) return
    const { position } = after
    if (before !== null) return this.view.emit(PLANNED, before, after)
    if (isSolid(after) !== position.y < this.ground) this.view.emit(PLANNED, { position, type: -1 }, after)
  }

  // Remember the position of the next step as obstructed: the agent got stuck there.
  feel (reason) {
    if (reason !== STUCK || this.path.length === 0) return
    const [next] = this.path
    this.felt.add(cellOf(next))
  }
}

module.exports = { Walker }
