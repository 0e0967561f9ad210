'use strict'
/**
 * What one agent does in windows, as its own clicks and the server's answers tell: which container it looks into, what
 * it moves in and out, what it crafts and takes out of furnaces, what it throws away.
 */
const { createLedger } = require('../server/plugins/lib/ledger')
const { equal, withCount } = require('../server/plugins/lib/items')
const { listOf, keyOf } = require('../server/plugins/lib/positions')
const { isFurnace, slotsIn } = require('./kinds')

const OWN = 0
const OUTSIDE = -999
const OUTPUT = 2
const RESULT = 0
const DROP_MODE = 4
// Ticks within which a server takes a click back.
const ANSWERED_WITHIN = 20

class Windows {
  /**
   * @param {object} witness of the agent: `emitEvent`, `countAct`, `threw(item)`, `lookedAt()` where it used something last,
   *   `tick`
   * @param {object} scene `at(position)`, `halvesAt(position)`, `contents`
   * @param {object} Item class of the version
   */
  constructor (witness, scene, Item) {
    this.witness = witness
    this.scene = scene
    this.Item = Item
    this.own = []
    this.reset()
  }

  /** Nothing is open; what was moved until now stays to be told. */
  reset () {
    this.opened = null
    this.cursor = null
  }

  /** Whether what a container holds is shown. */
  shows (position) {
    return this.opened !== null && this.opened.positions.some(place => place.equals(position))
  }

  get slots () {
    return this.opened?.slots ?? this.own
  }

  open ({ windowId }) {
    const used = this.witness.lookedAt()
    const positions = used !== null && slotsIn(this.scene.at(used).name) > 0 ? this.scene.halvesAt(used) : []
    const kind = positions.length > 0 ? this.scene.at(used).name : null
    this.opened = { id: windowId, used, positions, kind, slots: [], own: new Map(), isTold: false, ledger: null, isTable: used !== null && this.scene.at(used).name === 'crafting_table' }
    const { opened } = this
    opened.ledger = createLedger(positions, position => this.part(opened, position))
  }

  /** Slots of a part of an opened container. */
  part ({ positions, kind, slots }, position) {
    const index = positions.findIndex(other => keyOf(other) === keyOf(position))
    const size = slotsIn(kind)
    return Array.from({ length: size }, (_, slot) => slots[index * size + slot] ?? null)
  }

  size ({ positions, kind }) {
    return kind === null ? 0 : positions.length * slotsIn(kind)
  }

  show ({ windowId, items, carriedItem }) {
    const stacks = items.map(item => this.Item.fromNotch(item))
    if (windowId === OWN) this.own = stacks
    if (windowId !== this.opened?.id) {
      if (this.opened === null) this.cursor = this.Item.fromNotch(carriedItem)
      return
    }
    // It may have been sent before the latest clicks were handled.
    if (this.opened.own.size === 0) this.cursor = this.Item.fromNotch(carriedItem)
    stacks.forEach((stack, slot) => { this.hear(slot, stack) })
    this.tellContents()
    if (this.opened.isTold) return
    this.opened.isTold = true
    const { used, positions } = this.opened
    for (const position of [...positions].sort((a, b) => b.equals(used) - a.equals(used))) {
      this.witness.emitEvent({ kind: 'open_container', detail: { position: listOf(position) } })
    }
  }

  tellContents () {
    const { opened } = this
    if (opened.slots.length === 0) return
    for (const position of opened.positions) this.scene.contents.show(position, this.part(opened, position))
  }

  /** The server says what a slot holds: somebody else moved it, or it takes a click of the agent's back. */
  showSlot ({ windowId, slot, item }) {
    const stack = this.Item.fromNotch(item)
    if (windowId === OWN) this.own[slot] = stack
    if (windowId === -1 && slot === -1) this.cursor = stack
    const { opened } = this
    if (windowId !== opened?.id) return
    this.hear(slot, stack)
    this.tellContents()
  }

  /**
   * What the server says of a slot of the opened window. Where the agent has just clicked, it may be of before that or
   * between two clicks; it is looked at again when that time is over.
   */
  hear (slot, stack) {
    const { own, slots, kind } = this.opened
    const clicks = own.get(slot)
    const isKnown = clicks !== undefined && [clicks.before, ...clicks.after].some(each => equal(each, stack))
    // What is put into a fire is gone by itself, at any moment.
    if (isKnown && !isFurnace(kind ?? '')) {
      clicks.told = stack
      return
    }
    own.delete(slot)
    slots[slot] = stack
  }

  /** What the server said last of a slot that the agent clicked on holds: other clicks it has taken back. */
  forgetClicks () {
    const { opened, witness } = this
    for (const [slot, { tick, told }] of opened.own) {
      if (witness.tick - tick <= ANSWERED_WITHIN) continue
      opened.own.delete(slot)
      if (told === undefined || equal(told, opened.slots[slot])) continue
      const set = () => { opened.slots[slot] = told }
      if (slot < this.size(opened)) opened.ledger.record(set)
      else set()
      this.tellContents()
    }
  }

  click (packet) {
    const { windowId, slot, mode } = packet
    const slots = windowId === this.opened?.id ? this.opened.slots : this.own
    const before = { slots: [...slots], cursor: this.cursor }
    const apply = () => {
      for (const { location, item } of packet.changedSlots) slots[location] = this.Item.fromNotch(item)
    }
    this.cursor = this.Item.fromNotch(packet.cursorItem)
    if (windowId === this.opened?.id) this.move(packet, before, apply)
    else apply()
    if (slot === RESULT && (windowId === OWN || this.opened?.isTable)) this.tellMade('craft_item', before, RESULT)
    if (slot === OUTPUT && isFurnace(this.opened?.kind ?? '')) this.tellMade('smelt_item', before, OUTPUT)
    if (slot === OUTSIDE) this.threw(before.cursor, this.cursor)
    else if (mode === DROP_MODE) this.threw(before.slots[slot], slots[slot])
  }

  move ({ changedSlots }, before, apply) {
    const { opened } = this
    opened.ledger.record(apply)
    for (const { location } of changedSlots) {
      const clicks = opened.own.get(location) ?? { before: before.slots[location] ?? null, after: [] }
      clicks.after.push(opened.slots[location] ?? null)
      clicks.tick = this.witness.tick
      clicks.told = undefined
      opened.own.set(location, clicks)
    }
    this.tellContents()
  }

  /** What came out of a slot in which something was made. */
  tellMade (kind, before, slot) {
    const made = before.slots[slot]
    if (!made) return
    const number = stacks => stacks.reduce((sum, stack, index) => sum + (index !== slot && stack?.name === made.name ? stack.count : 0), 0)
    const count = number(this.slots) + (this.cursor?.name === made.name ? this.cursor.count : 0) -
      number(before.slots) - (before.cursor?.name === made.name ? before.cursor.count : 0)
    if (count > 0) this.witness.countAct(kind, withCount(made, count))
  }

  threw (before, after) {
    const count = (before?.count ?? 0) - (after?.count ?? 0)
    if (count > 0) this.witness.threw(withCount(before, count))
  }

  /** What was moved on balance, once nothing is on its way between container and inventory. */
  settle () {
    if (this.opened === null) return
    this.forgetClicks()
    if (this.cursor !== null) return
    for (const fact of this.opened.ledger.settle()) this.witness.emitEvent(fact)
  }

  close () {
    this.cursor = null
    this.settle()
    this.reset()
  }
}

module.exports = { Windows }
