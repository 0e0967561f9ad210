'use strict'
/**
 * Agents who are people with a client of their own, on a server elsewhere. Nobody hears what their clients send: what
 * they did is what the operator sees come of it, beside them and before their eyes.
 */
const { Person } = require('./person')

// Ticks after which one whom the server does not list has left: another connection may take the same place.
const GONE_AFTER = 20

class People {
  /**
   * @param {import('../regions/place').Place} region
   * @param {import('./operator').Operator} operator
   * @param {object} commands of commandsFor
   */
  constructor (region, operator, commands) {
    this.region = region
    this.operator = operator
    this.commands = commands
    // By agent; and how many ticks each has been away.
    this.here = new Map()
    this.away = new Map()
  }

  /** A person has taken the place of an agent's bot. */
  come (witness, latest) {
    const person = new Person(witness, this.operator, this.commands, latest)
    witness.person = person
    this.here.set(witness.agent, person)
    this.away.set(witness.agent, 0)
    return person
  }

  leave (agent) {
    const person = this.here.get(agent)
    if (person === undefined) return
    person.witness.person = null
    this.here.delete(agent)
    this.away.delete(agent)
  }

  /** Follow the operator's connection. */
  attach (bot) {
    bot.on('entitySwingArm', ({ username }) => this.here.get(username)?.swing(this.region.tick))
    bot.on('chat', (speaker, text) => this.said(speaker, text))
  }

  /** Somebody said, or whispered to an agent, what was heard now. */
  said (speaker, text, to) {
    if (!this.here.has(speaker)) return
    this.region.emit({ kind: 'chat', actor: speaker, detail: to === undefined ? { text } : { text, to } })
  }

  /** @returns {object | null} the witness of who most probably has used, mined or placed the block there */
  whoActed (position) {
    return this.nearest(position, person => person.mayHaveActedOn(position, this.region.tick))
  }

  /** @returns {object | null} the witness of who most probably has written on the sign there */
  whoWrote (position) {
    return this.nearest(position, person => person.offAim(position) < Infinity)
  }

  nearest (position, condition) {
    const all = [...this.here.values()].filter(condition).map(person => ({ person, off: person.offAim(position) }))
    const [found] = all.sort((a, b) => a.off - b.off || (a.person.agent < b.person.agent ? -1 : 1))
    return found?.person.witness ?? null
  }

  /** @returns {string | null} the agent from whose hand something came that appears at a place */
  whoThrew (position) {
    return [...this.here.values()].find(person => person.mayHaveThrown(position))?.agent ?? null
  }

  /** At the end of a tick. @returns {string[]} agents whose persons have left */
  endTick () {
    if (!this.operator.link.isHere) return []
    for (const [agent, person] of this.here) {
      person.endTick(this.region.tick)
      this.away.set(agent, person.isOnline ? 0 : this.away.get(agent) + 1)
    }
    return [...this.away].filter(([, ticks]) => ticks > GONE_AFTER).map(([agent]) => agent)
  }
}

module.exports = { People }
