'use strict'
/** Recorder of the changes in a region. It collects the changes of one tick and makes a frame of them. */
const { Claims } = require('./claims')

// Details of events that are positions.
const PLACES = ['position', 'destination']

class Recorder {
  /**
   * @param {import('./region').Region} region
   * @param {object} facts functions that read the server: `agents()` and `items()` for the present ones (in the form
   *   of the channel), `changedContainers()` since the last call as [x, y, z, ITEMS or null], `blockText(state)`, and
   *   `signText(position)` (scenario; empty if nothing is written)
   */
  constructor (region, facts) {
    this.region = region
    this.facts = facts
    this.reported = { agents: new Map(), items: new Map() }
    this.claims = new Claims(region)
    this.clear()
  }

  clear () {
    this.blocks = new Map()
    this.events = []
  }

  event ({ kind, actor, detail }) {
    if (kind === 'claims') this.claims.expect(actor, detail)
    else this.events.push(this.claims.completed({ kind, actor, detail }))
  }

  /** Record an event of a server plugin, whose positions are server coordinates. */
  serverEvent ({ kind, actor, detail }) {
    const translated = { ...detail }
    for (const key of PLACES) {
      const place = detail[key]
      if (place === undefined) continue
      const [x, y, z] = Array.isArray(place) ? place : [place.x, place.y, place.z]
      translated[key] = this.region.toScenario({ x, y, z })
    }
    this.event({ kind, actor, detail: translated })
  }

  /** Record that a block of the server's world became `state`. */
  blockChanged (position, state) {
    if (!this.region.contains(position)) return
    const place = this.region.toScenario(position)
    this.blocks.set(place.join(), [...place, state])
    this.event({
      kind: 'block_update', actor: null, detail: { position: place, block: this.facts.blockText(state) }
    })
  }

  /** Record that the text of a sign changed, whose block has `state`. */
  signChanged (position, state, text, actor) {
    const place = this.region.toScenario(position)
    this.blocks.set(place.join(), [...place, state])
    this.event({ kind: 'block_update', actor, detail: { position: place, block: this.facts.blockText(state), text } })
  }

  /** Return the row of a changed block, with its text if it is a sign. */
  row ([x, y, z, state]) {
    const text = this.facts.signText([x, y, z])
    return text === '' ? [x, y, z, state] : [x, y, z, state, text]
  }

  /** Drop claims that were announced but never said, so that none is left to the next call or branch. */
  forgetClaims () {
    this.claims = new Claims(this.region)
  }

  /** Take the present state as known, so that the next frames contain only differences from it. */
  settle () {
    this.changes('agents', this.facts.agents())
    this.changes('items', this.facts.items())
    this.facts.changedContainers()
    this.forgetClaims()
    this.clear()
  }

  /** Return the FRAME of the tick that ended; null if nothing changed. @returns {object | null} */
  frame () {
    const frame = {
      region: this.region.name,
      tick: this.region.tick,
      agents: this.changes('agents', this.facts.agents()),
      blocks: [...this.blocks.values()].map(block => this.row(block)),
      containers: this.facts.changedContainers(),
      items: this.changes('items', this.facts.items()),
      events: this.events
    }
    this.clear()
    const quiet = Object.keys(frame.agents).length === 0 && frame.blocks.length === 0 &&
      frame.containers.length === 0 && Object.keys(frame.items).length === 0 && frame.events.length === 0
    return quiet ? null : frame
  }

  changes (part, present) {
    const reported = this.reported[part]
    const changed = {}
    for (const [key, state] of Object.entries(present)) {
      if (reported.has(key) && equal(reported.get(key), state)) continue
      reported.set(key, state)
      changed[key] = state
    }
    for (const key of reported.keys()) {
      if (key in present) continue
      reported.delete(key)
      changed[key] = null
    }
    return changed
  }
}

/** Return true if two values of the channel (numbers, texts, lists, maps) are equal. */
function equal (a, b) {
  if (a === b) return true
  if (a === null || b === null || typeof a !== 'object' || typeof b !== 'object') return false
  const keys = Object.keys(a)
  return keys.length === Object.keys(b).length && keys.every(key => Object.hasOwn(b, key) && equal(a[key], b[key]))
}

module.exports = { Recorder }
