'use strict'

const { countByName, difference } = require('./items')
const { keyOf, listOf } = require('./positions')

/**
 * Create the account of one player's moves into and out of the parts of a container. `read(position)` returns the
 * slots of a part.
 */
function createLedger (positions, read) {
  const pending = new Map()

  function add (position, change) {
    const key = keyOf(position)
    const entry = pending.get(key) ?? { position, items: {} }
    for (const [name, count] of Object.entries(change)) {
      entry.items[name] = (entry.items[name] ?? 0) + count
    }
    pending.set(key, entry)
  }

  /** Run a move and record it. Return the parts that it changed. */
  function record (run) {
    const before = positions.map((position) => read(position).map((item) => item))
    run()
    return positions.filter((position, i) => {
      const now = read(position)
      add(position, difference(countByName(before[i]), countByName(now)))
      return now.some((item, slot) => item !== before[i][slot])
    })
  }

  function part (items, sign) {
    const entries = Object.entries(items).filter(([, count]) => count * sign > 0)
    return entries.length ? Object.fromEntries(entries.map(([n, c]) => [n, c * sign])) : null
  }

  /** Return the net moves since the last call as facts, items taken out first, and reset the account. */
  function settle () {
    const entries = [...pending.values()]
    pending.clear()
    const facts = (kind, sign) => entries.flatMap(({ position, items }) => {
      const moved = part(items, sign)
      return moved ? [{ kind, detail: { position: listOf(position), items: moved } }] : []
    })
    return [...facts('get_item_from_chest', -1), ...facts('deposit_item_into_chest', 1)]
  }

  return { record, settle }
}

module.exports = { createLedger }
