'use strict'
/** A person who is an agent on a server elsewhere: what the operator sees of them, and what the server says they have. */
const { EYE_HEIGHT } = require('../../../../programs/skills/lib/sight')
const { rounded, sorted } = require('../regions/facts')
const { wrap } = require('../server/angles')
const { possessionsIn } = require('../places/held')
const { listOf } = require('../server/plugins/lib/positions')

// Ticks after which one who stands has arrived, as in the embedded world.
const STANDING_TICKS = 10
// Ticks between two questions to the server about what somebody has.
const ASKED_EVERY = 20
// Ticks for which an arm that swung may be about something.
const SWUNG_WITHIN = 20
const REACH = 6
// Radians off the line of sight at which a block still may be what somebody acts on.
const AIM = 0.8
const FROM_THE_HAND = 1.5
// Places of what somebody wears and holds, as the protocol counts them.
const SLOTS = ['main_hand', 'off_hand', 'feet', 'legs', 'chest', 'head']

class Person {
  /**
   * @param {import('./witness').Witness} witness of the agent
   * @param {import('./operator').Operator} operator
   * @param {object} commands of commandsFor
   * @param {object} latest AGENT as it was known before
   */
  constructor (witness, operator, commands, latest) {
    this.witness = witness
    this.agent = witness.agent
    this.operator = operator
    this.commands = commands
    this.latest = latest
    this.last = null
    this.swungAt = -Infinity
    this.askedAt = -Infinity
    this.isAsking = false
    this.stood = { place: null, ticks: 0 }
  }

  /** What the operator sees of them; as it was last where they are out of its sight. */
  get entity () {
    this.last = this.operator.bot.players[this.agent]?.entity ?? this.last
    return this.last
  }

  get isOnline () {
    return this.operator.bot.players[this.agent] !== undefined
  }

  get eye () {
    return this.entity.position.offset(0, EYE_HEIGHT, 0)
  }

  swing (tick) {
    this.swungAt = tick
  }

  /** @returns {number} radians between where they look and the middle of a block; Infinity where they cannot reach it */
  offAim (position) {
    if (this.entity === null) return Infinity
    const way = position.offset(0.5, 0.5, 0.5).minus(this.eye)
    if (way.norm() > REACH) return Infinity
    const { yaw, headYaw, pitch } = this.entity
    const turned = headYaw ?? yaw
    const gaze = way.clone().set(-Math.sin(turned) * Math.cos(pitch), Math.sin(pitch), -Math.cos(turned) * Math.cos(pitch))
    return Math.acos(Math.max(-1, Math.min(1, gaze.dot(way) / way.norm())))
  }

  /** Whether they may just have used, mined or placed the block there. */
  mayHaveActedOn (position, tick) {
    return tick - this.swungAt <= SWUNG_WITHIN && this.offAim(position) <= AIM
  }

  /** Whether what appears at a place may come from their hand. */
  mayHaveThrown (position) {
    return this.entity !== null && this.eye.distanceTo(position) <= FROM_THE_HAND
  }

  /** @returns {object} AGENT */
  state () {
    if (this.entity === null) return this.latest
    const { position, yaw, headYaw, pitch, onGround } = this.entity
    this.latest = {
      ...this.latest, position: position.toArray().map(rounded), yaw: rounded(wrap(headYaw ?? yaw)), pitch: rounded(wrap(pitch)), on_ground: onGround, equipment: wornBy(this.entity)
    }
    return this.latest
  }

  /** At the end of a tick: who has come to stand after walking has moved there. */
  endTick (tick) {
    if (this.entity === null) return
    const { stood, entity: { position } } = this
    if (stood.place === null || !stood.place.equals(position)) Object.assign(stood, { place: position.clone(), ticks: 0 })
    else if (++stood.ticks === STANDING_TICKS) this.witness.report({ kind: 'move_to', detail: { destination: listOf(position.floored()) } })
    if (tick - this.askedAt < ASKED_EVERY || this.isAsking) return
    this.askedAt = tick
    this.ask().catch(error => this.witness.scene.fail(error))
  }

  /** Ask the server what they have; without an answer it stays what was known. */
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

/** @returns {object} name by slot of what can be seen that somebody wears and holds */
function wornBy ({ equipment }) {
  return Object.fromEntries(SLOTS.flatMap((slot, index) => equipment[index] ? [[slot, equipment[index].name]] : []))
}

module.exports = { Person, wornBy }
