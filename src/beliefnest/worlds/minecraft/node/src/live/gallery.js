'use strict'
/** Exhibits of the embedded server in real time, and their visitors. */
const { BadRequest } = require('../channel/errors')
const { Exhibit } = require('../exhibits/exhibit')
const { columnsOf, Ground } = require('../regions/ground')
const { blockStates } = require('../server/plugins/lib/states')
const { columnPacket } = require('../server/world')
const { Visitor } = require('./visitor')

// Distance from a box, in blocks, at which a visitor still counts as looking at it.
const MARGIN = 64
const FIRST_NUMBER = 2

class Gallery {
  /**
   * @param {object} serv server whose tables are used; its players and blocks are not
   */
  constructor (serv) {
    this.serv = serv
    this.states = blockStates(serv.registry)
    this.exhibits = new Map()
    this.visitors = new Set()
    // Entity id of each agent of an exhibit, by `EXHIBIT LABEL`.
    this.numbers = new Map()
    this.nextNumber = FIRST_NUMBER
  }

  /** Return where a visitor without a destination arrives: beside the exhibit that was opened first. */
  get entrance () {
    const [exhibit] = this.exhibits.values()
    const { x, y, z } = exhibit.stand
    return { exhibit, place: { x: x + 0.5, y, z: z + 0.5 } }
  }

  /** Return a line that tells people how to go to each exhibit. */
  directions () {
    return [...this.exhibits.values()].map(({ name, stand: { x, y, z } }) => `${name}: /tp ${x} ${y} ${z}`).join(', ')
  }

  open (description) {
    if (this.exhibits.has(description.exhibit)) throw new BadRequest(`${description.exhibit} is shown already; close it first`)
    this.exhibits.set(description.exhibit, new Exhibit(description))
  }

  /**
   * Apply changes to an exhibit and send them to its visitors.
   * @param {object} message `show` of the channel
   * @param {number} now tick of reality
   */
  show ({ exhibit: name, tick, ...changes }, now) {
    const exhibit = this.exhibits.get(name)
    if (exhibit === undefined) return
    exhibit.lag = Math.max(exhibit.lag, now - tick)
    const before = new Set(exhibit.agents.keys())
    const { signs } = exhibit.take(changes)
    for (const visitor of this.visitors) {
      if (visitor.exhibit === exhibit) visitor.tell({ ...changes, signs }, before)
    }
  }

  /** Return by how many ticks the changes of each exhibit were late, by name. @returns {object} */
  lags () {
    return Object.fromEntries([...this.exhibits.values()].map(({ name, lag }) => [name, lag]))
  }

  /** Close an exhibit. @returns {Visitor[]} its visitors, who have to go elsewhere */
  close (name) {
    const exhibit = this.exhibits.get(name)
    if (exhibit === undefined) throw new BadRequest(`${name} is not shown`)
    this.exhibits.delete(name)
    return [...this.visitors].filter(visitor => visitor.exhibit === exhibit)
  }

  /** Return the exhibit at a position of the server's world; null if there is none. @returns {Exhibit | null} */
  at (place) {
    return [...this.exhibits.values()].find(exhibit => exhibit.holds(place, MARGIN)) ?? null
  }

  /** Let a client in as a visitor. @returns {Visitor} */
  admit (client, onCommand) {
    const visitor = new Visitor(client, this, onCommand)
    this.visitors.add(visitor)
    visitor.end.on('end', () => this.visitors.delete(visitor))
    return visitor
  }

  numberOf (exhibit, label) {
    const key = `${exhibit.name} ${label}`
    if (!this.numbers.has(key)) this.numbers.set(key, this.nextNumber++)
    return this.numbers.get(key)
  }

  /** Return the packets of an exhibit's columns. @returns {object[]} */
  columns (exhibit) {
    const ground = new Ground(this.serv, exhibit, exhibit.blocks, false)
    return columnsOf(exhibit.box, exhibit.origin).map(([x, z]) => columnPacket(ground.column(x, z), x, z))
  }
}

module.exports = { Gallery }
