'use strict'

const { flawOf } = require('../../../../../programs/skills/lib/text')

/** How far from where somebody stands a place may be at which it says to have arrived: an arm's length. */
const NEAR = 3
/** How much one agent can utter in a tick. */
const MOST_UTTERANCES = 20

const isPoint = (value) => Array.isArray(value) && value.length === 3 && value.every(Number.isFinite)

/**
 * What agents say of themselves through skills (`player.report`): thoughts, gestures, what their words claim, and
 * arrivals. All but the last are their own; where somebody has walked to is what the server finds. Nothing else can
 * be told: what is done to the world the server sees for itself.
 */
module.exports.server = (serv) => {
  serv.onTick(() => serv.players.forEach((player) => { player.uttered = 0 }))
}

module.exports.player = (player, serv) => {
  player.uttered = 0
  const emit = (kind, detail) => serv.region.emit({ kind, actor: player.agent, detail })

  /** To be called before anything is uttered. @throws {RangeError} if it cannot be */
  player.utter = (text) => {
    const flaw = typeof text === 'string' ? flawOf(text) : 'must be a text'
    if (flaw !== null) throw new RangeError(`what ${player.agent} utters ${flaw}.`)
    if (player.uttered >= MOST_UTTERANCES) {
      throw new RangeError(`${player.agent} has uttered ${MOST_UTTERANCES} things in one tick, which is the most. Wait a tick between them.`)
    }
    player.uttered += 1
  }

  const REPORTS = {
    think ({ text }) {
      player.utter(text)
      emit('think', { text })
    },
    emote ({ name, other }) {
      player.utter(name)
      if (other !== undefined && !serv.players.some(({ agent }) => agent === other)) throw new RangeError(`there is no agent ${other} here.`)
      emit('emote', other === undefined ? { name } : { name, other })
    },
    /** What its next utterance of that text claims (../../regions/claims.js). */
    claims (detail) {
      emit('claims', detail)
    },
    /** Told if it has walked since it last told, and where it stands if that is not near the place it names. */
    move_to ({ destination }) {
      const here = player.position.floored()
      if (!isPoint(destination)) throw new RangeError('a destination is three finite numbers.')
      if (here.equals(player.stoodAt)) return
      player.stoodAt = here
      const near = here.distanceTo(serv.region.toServer(destination).floored()) <= NEAR
      emit('move_to', { destination: near ? destination : serv.region.toScenario(here) })
    },
  }

  /** @throws {RangeError} for what cannot be told, or not so */
  player.report = ({ kind, detail }) => {
    if (!Object.hasOwn(REPORTS, kind)) throw new RangeError(`an event of kind ${kind} is for the server to tell.`)
    REPORTS[kind](detail)
  }
}
