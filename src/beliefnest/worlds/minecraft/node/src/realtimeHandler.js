'use strict'
const { BadRequest } = require('./channel/errors')
const { RequestHandler } = require('./requestHandler')

const BEAT_MS = 500

/**
 * Handler of requests in real time. A request may wait for a tick or for a server; meanwhile the handler sends
 * heartbeats.
 */
class RealtimeHandler extends RequestHandler {
  async answer (request) {
    const beating = setInterval(() => this.beat({ beat: this.tick }), BEAT_MS)
    try {
      return await super.answer(request)
    } finally {
      clearInterval(beating)
    }
  }
}

/** Refuse programs for agents whose places people may take. @throws {BadRequest} if there is such an agent */
function requireBots (invited, agents) {
  const person = agents.find(agent => invited.has(agent))
  if (person === undefined) return
  throw new BadRequest(`${person} is a person, for whom no program acts; take ${person} over first: nest.take_over("${person}")`)
}

module.exports = { RealtimeHandler, requireBots }
