'use strict'
/** Checks of the arguments that a program passes to a skill. Every `fail(message)` throws. */

const MOST_SHOWN = 200
const LONGEST_NAME = 100

/**
 * Return a value as text for a message. Primitives and positions are shown themselves, other values only by their
 * type: turning game objects into text is slow and would show more than a program may know.
 */
function show (value) {
  if (typeof value === 'string') return `"${shortened(value)}"`
  if (typeof value === 'function') return 'a function'
  if (typeof value !== 'object' || value === null) return shortened(String(value))
  if (typeof value.x === 'number') return shortened(`(${[value.x, value.y, value.z].map(part).join(', ')})`)
  if (Array.isArray(value)) return `a list of ${value.length}`
  return Object.getPrototypeOf(value) === Object.prototype ? 'an object' : 'an object of the game'
}

const part = value => (typeof value === 'object' && value !== null ? 'an object' : show(value))

function shortened (text, most = MOST_SHOWN) {
  return (text.length > most ? `${text.slice(0, most - 4)} ...` : text).toWellFormed()
}

/** Return a position if its coordinates are finite; fail otherwise. @returns {Vec3} */
function position ({ Vec3, fail }, name, value) {
  const parts = [value?.x, value?.y, value?.z]
  if (!parts.every(Number.isFinite)) {
    fail(`${name} must be a Vec3 of three finite numbers, like new Vec3(0, -51, 3); it is ${show(value)}`)
  }
  return new Vec3(...parts)
}

/** Return the position of the block that contains a position. @returns {Vec3} */
function blockPosition (context, name, value) {
  return position(context, name, value).floored()
}

function count ({ fail }, name, value) {
  if (!Number.isInteger(value) || value < 1) fail(`${name} must be a whole number of at least 1; it is ${show(value)}`)
  return value
}

function distance ({ fail }, name, value) {
  if (!Number.isFinite(value) || value < 0) fail(`${name} must be a number of at least 0; it is ${show(value)}`)
  return value
}

/** Return true-or-false options, with `defaults` for those that are left out. @returns {object} */
function flags ({ fail }, name, value, defaults) {
  const names = Object.keys(defaults)
  const entries = value !== null && typeof value === 'object' && !Array.isArray(value) ? Object.entries(value) : null
  if (entries === null || !entries.every(([key, flag]) => names.includes(key) && typeof flag === 'boolean')) {
    const wrong = entries?.find(([key, flag]) => !names.includes(key) || typeof flag !== 'boolean')
    const shown = wrong ? `${show(wrong[0])}: ${show(wrong[1])}` : show(value)
    fail(`${name} may have ${names.join(' and ')}, each true or false, like {${names[0]}: ${!defaults[names[0]]}}; it is ${shown}`)
  }
  return { ...defaults, ...Object.fromEntries(entries) }
}

function text ({ fail }, name, value) {
  if (typeof value !== 'string' || value.trim() === '') fail(`${name} must be a text that is not empty; it is ${show(value)}`)
  return value
}

/**
 * Return a hint that lists the names that contain the given name or are contained in it; empty if the name is too long
 * or nothing is similar.
 */
function similar (name, names) {
  if (name.length > LONGEST_NAME) return ''
  const close = names.filter(other => other.includes(name) || name.includes(other)).slice(0, 4)
  return close.length ? `; similar names: ${close.join(', ')}` : ''
}

const entryOf = (table, name) => (typeof name === 'string' && Object.hasOwn(table, name) ? table[name] : undefined)

/** Return minecraft-data's entry of an item. @returns {object} */
function item ({ bot, fail }, name, value) {
  const item = entryOf(bot.registry.itemsByName, value)
  if (!item) {
    const hint = typeof value === 'string' ? similar(value, Object.keys(bot.registry.itemsByName)) : ''
    fail(`${name} must be the name of an item, like "diamond"; it is ${show(value)}${hint}`)
  }
  return item
}

/** Return minecraft-data's entry of a block. @returns {object} */
function block ({ bot, fail }, name, value) {
  const block = entryOf(bot.registry.blocksByName, value)
  if (!block) {
    const hint = typeof value === 'string' ? similar(value, Object.keys(bot.registry.blocksByName)) : ''
    fail(`${name} must be the name of a block, like "stone"; it is ${show(value)}${hint}`)
  }
  return block
}

/** Return minecraft-data's entries of items, each with its count. @returns {[object, number][]} */
function items (context, name, value) {
  const entries = value !== null && typeof value === 'object' && !Array.isArray(value) ? Object.entries(value) : []
  if (entries.length === 0) {
    const shown = value?.constructor === Object ? 'empty' : show(value)
    context.fail(`${name} must say how many of which items, like {diamond: 1}; it is ${shown}`)
  }
  return entries.map(([key, number]) => [item(context, `each name in ${name}`, key), count(context, `${name}.${key}`, number)])
}

/** Return the name of another agent that is present; fail otherwise. @returns {string} */
function otherAgent ({ bot, fail }, name, value) {
  const others = Object.keys(bot.players).filter(other => other !== bot.username)
  if (!others.includes(value)) {
    fail(`${name} must be the name of another agent; it is ${show(value)}. Agents here: ${others.toSorted().join(', ') || 'none'}`)
  }
  return value
}

module.exports = { show, shortened, position, blockPosition, count, distance, flags, text, item, block, items, otherAgent }
