'use strict'
/**
 * Claims of utterances that are still on their way. A skill announces the claims of a text; the server later reports
 * that the text was said or written.
 */

// Largest number of announced texts; a program that ended early never says its text.
const MOST_WAITING = 64

class Claims {
  /** @param {import('./region').Region} region */
  constructor (region) {
    this.region = region
    this.waiting = []
  }

  /**
   * Announce an utterance with claims.
   * @param {string} actor agent that will speak, or write on the sign at `position`
   * @param {{text: string, to?: string, position?: number[], claims: object[]}} utterance
   * @throws {Error} if a claim mentions a position outside the box, or an unknown agent
   */
  expect (actor, { text, to, position, claims }) {
    claims.forEach(claim => this.check(claim))
    this.waiting.push({ actor, text, to, position: position?.join(), claims })
    if (this.waiting.length > MOST_WAITING) this.waiting.shift()
  }

  /** Return the event, with claims if it is an announced utterance or writing. @returns {object} */
  completed (event) {
    const { kind, actor, detail: { text, to, position } } = event
    const where = kind === 'block_update' ? position.join() : undefined
    const index = kind !== 'chat' && kind !== 'block_update'
      ? -1
      : this.waiting.findIndex(claim => claim.actor === actor && claim.text === text && claim.to === to && claim.position === where)
    if (index < 0) return event
    const [{ claims }] = this.waiting.splice(index, 1)
    return { ...event, detail: { ...event.detail, claims } }
  }

  check ({ kind, place, agent }) {
    const { box, agentNames } = this.region
    if (!box.contains(...place.map(Math.floor))) {
      throw new Error(`the claim (${kind}) speaks of (${place.join(', ')}), which lies outside the box of this world`)
    }
    if (agent !== undefined && !agentNames.has(agent)) {
      throw new Error(`the claim (${kind}) names "${agent}"; there are the agents ${[...agentNames].join(', ')}`)
    }
  }
}

module.exports = { Claims }
