'use strict'

const { countByName, stacksOf } = require('./lib/items')
const { keyOf, vecOf } = require('./lib/positions')

/**
 * What containers hold, by block position; each half of a double chest holds its own 27 slots.
 *
 * `serv.containers.get(position)` is `{name: count}`, or null where no container stands
 * `.set(position, counts)` makes it hold exactly that (RangeError where it cannot)
 * `.drainChanges(within)` are the positions of a part of the world whose content changed, or
 * whose container came or went, since the last call.
 */
module.exports.server = (serv) => {
  const sizes = new Map()
  const arrangements = new Map()
  const stored = new Map()
  const changed = new Map()

  const sizeAt = (position) => sizes.get(serv.blocks.at(position).name)

  /**
   * Declares a kind of block that holds items. `arrange(stacks)` gives the slots a content is
   * set into, or null where it does not fit; by default one after the other.
   */
  function define (name, size, arrange = (stacks) => (stacks.length > size ? null : stacks)) {
    sizes.set(name, size)
    arrangements.set(name, arrange)
  }

  /** The slots of the container at a position; only for those who call `touch` afterwards. */
  function slots (position) {
    const key = keyOf(position)
    if (!stored.has(key)) {
      stored.set(key, { position: vecOf(position), slots: new Array(sizeAt(position)).fill(null) })
    }
    return stored.get(key).slots
  }

  /** To be called after slots were changed: notes it and shows it to those who look in. */
  function touch (position) {
    const key = keyOf(position)
    changed.set(key, vecOf(position))
    for (const player of serv.players) {
      if (player.windows.open?.positions?.some((open) => keyOf(open) === key)) player.syncWindow()
    }
  }

  function get (position) {
    if (sizeAt(position) === undefined) return null
    return countByName(stored.get(keyOf(position))?.slots ?? [])
  }

  function set (position, counts) {
    const size = sizeAt(position)
    if (size === undefined) {
      throw new RangeError(`no container at (${position.x}, ${position.y}, ${position.z}): ` +
        `the block there is ${serv.blocks.at(position).name}`)
    }
    const stacks = stacksOf(serv.Item, serv.registry, counts)
    const { name } = serv.blocks.at(position)
    const arranged = arrangements.get(name)(stacks)
    if (arranged === null) {
      throw new RangeError(`the ${stacks.length} stacks given do not fit into the ${size} slots of the ` +
        `${name} at (${position.x}, ${position.y}, ${position.z})`)
    }
    const own = slots(position)
    own.forEach((_, i) => { own[i] = arranged[i] ?? null })
    touch(position)
  }

  function closeViewers (position) {
    for (const player of serv.players) {
      const { open } = player.windows
      if (open?.positions?.some((other) => keyOf(other) === keyOf(position))) player.forceCloseWindow()
    }
  }

  /** A container that is broken by somebody spills; one that is replaced otherwise is gone. */
  serv.blocks.on('change', ({ position, before, after, player }) => {
    const old = serv.blocks.describe(before).name
    const now = serv.blocks.describe(after).name
    if (old === now || !(sizes.has(old) || sizes.has(now))) return
    const content = stored.get(keyOf(position))
    closeViewers(position)
    stored.delete(keyOf(position))
    changed.set(keyOf(position), position)
    if (content && player) content.slots.filter(Boolean).forEach((item) => serv.popItem(position, item))
  })

  function drainChanges (within) {
    const result = [...changed.values()].filter(within)
    result.forEach((position) => changed.delete(keyOf(position)))
    return result
  }

  /** Positions of a part of the world whose containers ever held something. */
  const positions = (within) => [...stored.values()].map((entry) => entry.position).filter(within)

  function forget (within) {
    positions(within).forEach((position) => {
      closeViewers(position)
      stored.delete(keyOf(position))
    })
    drainChanges(within)
  }

  serv.onForget(forget)
  serv.containers = { define, slots, touch, get, set, drainChanges, positions, forget }
}
