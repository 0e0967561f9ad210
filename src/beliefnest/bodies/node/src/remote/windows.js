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
    this.cursor = this.Item.fromNotch(carriedItem)
    if (windowId === OWN) this.own = stacks
    if (windowId !== this.opened?.id) return
    this.opened.slots = stacks
    this.opened.own.clear()
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
    if (this.isEcho(slot, stack)) return
    const set = () => { opened.slots[slot] = stack }
    const clicks = opened.own.get(slot)
    opened.own.delete(slot)
    if (clicks !== undefined && equal(clicks.before, stack) && slot < this.size(opened)) opened.ledger.record(set)
    else set()
    this.tellContents()
  }

  /** Whether the server only says what a click of the agent's led to; further clicks may have followed meanwhile. */
  isEcho (slot, stack) {
    const clicks = this.opened.own.get(slot)
    const index = clicks?.after.findIndex(each => equal(each, stack)) ?? -1
    if (index < 0) return false
    clicks.after.splice(0, index + 1)
    if (clicks.after.length === 0) this.opened.own.delete(slot)
    return true
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
    // A server that agrees says nothing of a click.
    for (const [slot, { tick }] of this.opened.own) if (this.witness.tick - tick > ANSWERED_WITHIN) this.opened.own.delete(slot)
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
