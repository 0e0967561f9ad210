'use strict'
/** Claims on their way: a skill tells what it is about to say or to write claims, the server what was said or written. */

// What was never said, because its program ended first, is not kept for ever.
const MOST_WAITING = 64

class Claims {
  /** @param {import('./region').Region} region */
  constructor (region) {
    this.region = region
    this.waiting = []
  }

  /**
   * @param {string} actor who is about to speak, or to write on the sign at `position`
   * @param {{text: string, to?: string, position?: number[], claims: object[]}} utterance
   * @throws {Error} if a claim speaks of a place outside the box, or of an unknown agent
   */
  expect (actor, { text, to, position, claims }) {
    claims.forEach(claim => this.check(claim))
    this.waiting.push({ actor, text, to, position: position?.join(), claims })
    if (this.waiting.length > MOST_WAITING) this.waiting.shift()
  }

  /** @returns {object} the event, with what it claims if it is an utterance or a writing that was expected */
  completed (event) {
    const { kind, actor, detail: { text, to, position } } = event
    const where = kind === 'block_update' ? position.join() : undefined
    const index = kind !== 'chat' && kind !== 'block_update'
      ? -1
      : this.waiting.findIndex(told => told.actor === actor && told.text === text && told.to === to && told.position === where)
    if (index < 0) return event
    const [{ claims }] = this.waiting.splice(index, 1)
    return { ...event, detail: { ...event.detail, claims } }
  }

  check ({ kind, place, agent }) {
    const { box, known } = this.region
    if (!box.contains(...place.map(Math.floor))) {
      throw new Error(`the claim (${kind}) speaks of (${place.join(', ')}), which lies outside the box of this world`)
    }
    if (agent !== undefined && !known.has(agent)) {
      throw new Error(`the claim (${kind}) names "${agent}"; there are the agents ${[...known].join(', ')}`)
    }
  }
}

module.exports = { Claims }
