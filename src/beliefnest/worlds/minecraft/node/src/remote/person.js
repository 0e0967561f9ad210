'use strict'
/**
 * Person who plays an agent on a remote server: what the operator sees of them, and the server's data of their
 * possessions.
 */
const { Vec3 } = require('vec3')
const { EYE_HEIGHT } = require('../../../../../skills/code/lib/sight')
const { rounded, sorted } = require('../regions/facts')
const { wrap } = require('../server/angles')
const { possessionsIn } = require('../places/held')
const { listOf } = require('../server/plugins/lib/positions')

// Number of ticks after which a standing person counts as arrived, as in the embedded world.
const STANDING_TICKS = 10
// Number of ticks between two queries of a person's possessions.
const ASKED_EVERY = 20
// Number of ticks after a swing of the arm in which an effect may be its consequence.
const SWUNG_WITHIN = 20
const REACH = 6
// Largest angle, in radians, between the line of sight and a block on which the person may act.
const AIM = 0.8
const FROM_THE_HAND = 1.5
// Equipment slots in the protocol's order.
const SLOTS = ['main_hand', 'off_hand', 'feet', 'legs', 'chest', 'head']

class Person {
  /**
   * @param {import('./witness').Witness} witness witness of the agent
   * @param {import('./operator').Operator} operator
   * @param {object} commands of commandsFor
   * @param {object} latest last known AGENT
   */
  constructor (witness, operator, commands, latest) {
    this.witness = witness
    this.agent = witness.agent
    this.operator = operator
    this.commands = commands
    this.latest = latest
    this.last = null
    this.swungAt = -Infinity
    // Places of the eye with directions of view, {eye, gaze, at}, in order: those of the last moments. Several may have
    // come in one tick, and what they do is judged at its end, when they may look elsewhere.
    this.views = []
    this.askedAt = -Infinity
    this.isAsking = false
    this.stood = { place: null, ticks: 0 }
  }

  /** Return the entity that the operator sees; the last one seen if they are out of sight. */
  get entity () {
    this.last = this.operator.bot.players[this.agent]?.entity ?? this.last
    return this.last
  }

  get isOnline () {
    return this.operator.bot.players[this.agent] !== undefined
  }

  swing (now) {
    this.swungAt = now
    this.look(now)
  }

  /** Note where they are and look now. */
  look (now) {
    if (this.entity === null) return
    const { position, yaw, headYaw, pitch } = this.entity
    const turned = headYaw ?? yaw
    const gaze = new Vec3(-Math.sin(turned) * Math.cos(pitch), Math.sin(pitch), -Math.cos(turned) * Math.cos(pitch))
    this.views.push({ eye: position.offset(0, EYE_HEIGHT, 0), gaze, at: now })
    // A view lasts until the next one.
    this.views = this.views.filter((_, index, { [index + 1]: next }) => next === undefined || now - next.at <= SWUNG_WITHIN)
  }

  /**
   * Return the smallest angle, in radians, between one of their last views and the middle of a block; Infinity if they
   * could not reach it.
   * @returns {number}
   */
  offAim (position) {
    return Math.min(Infinity, ...this.views.map(({ eye, gaze }) => {
      const way = position.offset(0.5, 0.5, 0.5).minus(eye)
      return way.norm() > REACH ? Infinity : Math.acos(Math.max(-1, Math.min(1, gaze.dot(way) / way.norm())))
    }))
  }

  /** Return true if they may just have used, mined or placed the block. */
  mayHaveActedOn (position, now) {
    return now - this.swungAt <= SWUNG_WITHIN && this.offAim(position) <= AIM
  }

  /** Return true if an item that appears at a position may come from their hand. */
  mayHaveThrown (position) {
    return this.views.some(({ eye }) => eye.distanceTo(position) <= FROM_THE_HAND)
  }

  /** Return AGENT. @returns {object} */
  state () {
    if (this.entity === null) return this.latest
    const { position, yaw, headYaw, pitch, onGround } = this.entity
    this.latest = {
      ...this.latest, position: position.toArray().map(rounded), yaw: rounded(wrap(headYaw ?? yaw)), pitch: rounded(wrap(pitch)), on_ground: onGround, equipment: wornBy(this.entity)
    }
    return this.latest
  }

  /** Report a `move_to` if they have come to stand after walking; called at the end of a tick. */
  endTick (tick, now) {
    if (this.entity === null) return
    if (this.views.length === 0) this.look(now)
    const { stood, entity: { position } } = this
    if (stood.place === null || !stood.place.equals(position)) Object.assign(stood, { place: position.clone(), ticks: 0 })
    else if (++stood.ticks === STANDING_TICKS) this.witness.report({ kind: 'move_to', detail: { destination: listOf(position.floored()) } })
    if (tick - this.askedAt < ASKED_EVERY || this.isAsking) return
    this.askedAt = tick
    this.ask().catch(error => this.witness.scene.fail(error))
  }

  /** Query their possessions from the server; without an answer the known ones stay. */
  async ask () {
    if (!this.operator.can('data')) return
    this.isAsking = true
    try {
      const data = await this.operator.ask(this.commands.dataOf(this.agent))
      if (data === null) return
      const { inventory } = possessionsIn(data, data.SelectedItemSlot ?? 0)
      this.latest = { ...this.latest, inventory: sorted(inventory), health: data.Health, food: data.foodLevel }
    } finally {
      this.isAsking = false
    }
  }
}

/** Return the names of visible equipment by slot. @returns {object} */
function wornBy ({ equipment }) {
  return Object.fromEntries(SLOTS.flatMap((slot, index) => equipment[index] ? [[slot, equipment[index].name]] : []))
}

module.exports = { Person, wornBy }
