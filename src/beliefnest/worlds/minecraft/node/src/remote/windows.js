'use strict'
/**
 * Acts of one agent in windows, inferred from its own clicks and the server's answers: which container it opens, which
 * items it moves in and out, crafts, takes out of furnaces and throws away.
 */
const { createLedger } = require('../server/plugins/lib/ledger')
const { equal, withCount } = require('../server/plugins/lib/items')
const { listOf } = require('../server/plugins/lib/positions')
const { isFurnace, slotsIn } = require('./kinds')

const OWN = 0
const OUTSIDE = -999
const OUTPUT = 2
const RESULT = 0
const DROP_MODE = 4
// Number of ticks in which a server may undo a click.
const ANSWERED_WITHIN = 20

class Windows {
  /**
   * @param {object} witness witness of the agent: `emitEvent`, `countAct`, `threw(item)`, `lookedAt()` for the block
   *   it used last, `followed`
   * @param {object} scene `at(position)`, `halvesAt(position)`, `contents`
   * @param {object} Item Item class of the version
   */
  constructor (witness, scene, Item) {
    this.witness = witness
    this.scene = scene
    this.Item = Item
    this.own = []
    this.reset()
  }

  /** Close everything; moves up to now are still reported. */
  reset () {
    this.opened = null
    this.cursor = null
  }

  /** Return true if an open window shows the contents of the container. */
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
    this.opened = { id: windowId, positions, kind, slots: [], own: new Map(), isTold: false, ledger: null, isTable: used !== null && this.scene.at(used).name === 'crafting_table' }
    const { opened } = this
    opened.ledger = createLedger(positions.slice(0, 1), () => this.stacksIn(opened))
  }

  /** Return the slots of the container of an opened window. */
  stacksIn (opened) {
    return Array.from({ length: this.size(opened) }, (_, slot) => opened.slots[slot] ?? null)
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
    // The message may have been sent before the latest clicks were handled.
    if (this.opened.own.size === 0) this.cursor = this.Item.fromNotch(carriedItem)
    stacks.forEach((stack, slot) => { this.hear(slot, stack) })
    this.tellContents()
    if (this.opened.isTold) return
    this.opened.isTold = true
    for (const position of this.opened.positions.slice(0, 1)) {
      this.witness.emitEvent({ kind: 'open_container', detail: { position: listOf(position) } })
    }
  }

  tellContents () {
    const { opened } = this
    if (opened.slots.length === 0) return
    for (const position of opened.positions.slice(0, 1)) this.scene.contents.show(position, this.stacksIn(opened))
  }

  /** Handle the server's content of a slot: somebody else moved an item, or the server undid a click of the agent. */
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
   * Handle the server's content of a slot in the opened window. In a slot that the agent has just clicked, the message
   * may describe the state before or between two clicks; `forgetClicks` checks it again later.
   */
  hear (slot, stack) {
    const { own, slots, kind } = this.opened
    const clicks = own.get(slot)
    const isKnown = clicks !== undefined && [clicks.before, ...clicks.after].some(each => equal(each, stack))
    // Fires use up their items by themselves, at any moment.
    if (isKnown && !isFurnace(kind ?? '')) {
      clicks.sent = stack
      return
    }
    own.delete(slot)
    slots[slot] = stack
  }

  /**
   * Accept the server's last content of slots whose last click is old. If it differs from the expected one, the server
   * has undone the click.
   */
  forgetClicks () {
    const { opened, witness } = this
    for (const [slot, { at, sent }] of opened.own) {
      if (witness.followed - at <= ANSWERED_WITHIN) continue
      opened.own.delete(slot)
      if (sent === undefined || equal(sent, opened.slots[slot])) continue
      const set = () => { opened.slots[slot] = sent }
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
      clicks.at = this.witness.followed
      clicks.sent = undefined
      opened.own.set(location, clicks)
    }
    this.tellContents()
  }

  /** Report items that were taken out of the slot in which they were made. */
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

  /** Report the net moves, once no item is on its way between container and inventory. */
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
