'use strict'
/**
 * Agents that people play with clients of their own, on a remote server. We do not receive their clients' packets;
 * what they do is inferred from the effects that the operator sees near them and in their line of sight.
 */
const { Person } = require('./person')

// Number of ticks after which a player whom the server does not list has left. A new connection may replace the old
// one before.
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
    // By agent: its person, and for how many ticks they have been missing.
    this.here = new Map()
    this.away = new Map()
  }

  /** Begin to follow a person who has replaced an agent's bot. */
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

  /** Listen to the operator's connection. */
  attach (bot) {
    bot.on('entitySwingArm', ({ username }) => this.here.get(username)?.swing(this.region.followed))
    bot.on('entityMoved', ({ username }) => this.here.get(username)?.look(this.region.followed))
    bot.on('chat', (speaker, text) => this.said(speaker, text))
  }

  /** Handle words that were heard now, said aloud or whispered to an agent. */
  said (speaker, text, to) {
    if (!this.here.has(speaker)) return
    this.region.emit({ kind: 'chat', actor: speaker, detail: to === undefined ? { text } : { text, to } })
  }

  /**
   * Return the witness of the person who most probably used, mined or placed the block; null if there is none.
   * @returns {object | null}
   */
  whoActed (position) {
    return this.nearest(position, person => person.mayHaveActedOn(position, this.region.followed))
  }

  /**
   * Return the witness of the person who most probably wrote on the sign; null if there is none.
   * @returns {object | null}
   */
  whoWrote (position) {
    return this.nearest(position, person => person.offAim(position) < Infinity)
  }

  nearest (position, condition) {
    const all = [...this.here.values()].filter(condition).map(person => ({ person, off: person.offAim(position) }))
    const [nearest] = all.sort((a, b) => a.off - b.off || (a.person.agent < b.person.agent ? -1 : 1))
    return nearest?.person.witness ?? null
  }

  /**
   * Return the agent who most probably threw an item that appears at a position; null if there is none.
   * @returns {string | null}
   */
  whoThrew (position) {
    return [...this.here.values()].find(person => person.mayHaveThrown(position))?.agent ?? null
  }

  /** Update everybody; called at the end of a tick. @returns {string[]} agents whose people have left */
  endTick () {
    if (!this.operator.link.isHere) return []
    for (const [agent, person] of this.here) {
      person.endTick(this.region.tick, this.region.followed)
      this.away.set(agent, person.isOnline ? 0 : this.away.get(agent) + 1)
    }
    return [...this.away].filter(([, ticks]) => ticks > GONE_AFTER).map(([agent]) => agent)
  }
}

module.exports = { People }
