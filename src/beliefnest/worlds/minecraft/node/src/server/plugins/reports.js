'use strict'

const { flawOf } = require('../../../../../../skills/code/lib/text')

/** Largest distance between a player and the position at which it reports to have arrived: an arm's length. */
const NEAR = 3
/** Largest number of utterances of one agent in a tick. */
const MOST_UTTERANCES = 20

const isPoint = (value) => Array.isArray(value) && value.length === 3 && value.every(Number.isFinite)

/**
 * Add reports of agents about themselves through skills (`player.report`): thoughts, gestures, claims of their words,
 * and arrivals. The server checks arrivals against the agent's real position. Other events cannot be reported, because
 * the server sees acts on the world itself.
 */
module.exports.server = (serv) => {
  serv.onTick(() => serv.players.forEach((player) => { player.uttered = 0 }))
}

module.exports.player = (player, serv) => {
  player.uttered = 0
  const emit = (kind, detail) => serv.region.emit({ kind, actor: player.agent, detail })

  /** Check and count an utterance; called before anything is uttered. @throws {RangeError} if it cannot be uttered */
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
    /** Announce the claims of the agent's next utterance of that text (../../regions/claims.js). */
    claims (detail) {
      emit('claims', detail)
    },
    /**
     * Report an arrival if the agent has walked since its last one; if it is not near the named position, report its
     * real position.
     */
    move_to ({ destination }) {
      const here = player.position.floored()
      if (!isPoint(destination)) throw new RangeError('a destination is three finite numbers.')
      if (here.equals(player.stoodAt)) return
      player.stoodAt = here
      const near = here.distanceTo(serv.region.toServer(destination).floored()) <= NEAR
      emit('move_to', { destination: near ? destination : serv.region.toScenario(here) })
    },
  }

  /** Report an event of a skill. @throws {RangeError} if it is not allowed or not valid */
  player.report = ({ kind, detail }) => {
    if (!Object.hasOwn(REPORTS, kind)) throw new RangeError(`an event of kind ${kind} is for the server to tell.`)
    REPORTS[kind](detail)
  }
}
