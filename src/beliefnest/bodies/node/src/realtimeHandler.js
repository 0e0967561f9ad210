'use strict'
const { BadRequest } = require('./channel/errors')
const { RequestHandler } = require('./requestHandler')

const BEAT_MS = 500

/** Answers requests in real time: one may wait for a tick or for a server, and Node says meanwhile that it lives. */
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

/** @throws {BadRequest} if a program is to act for an agent whose place a person may take */
function requireBots (invited, agents) {
  const person = agents.find(agent => invited.has(agent))
  if (person === undefined) return
  throw new BadRequest(`${person} is a person, for whom no program acts; take ${person} over first: nest.take_over("${person}")`)
}

module.exports = { RealtimeHandler, requireBots }
