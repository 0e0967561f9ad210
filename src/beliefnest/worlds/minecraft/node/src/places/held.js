'use strict'
/** Readers of item and sign data in the game's own format, as files and `/data` give it, across versions. */

const LINES = 4
// The game's own limit.
const DEEPEST = 512
const FIRST_ARMOUR = 100
const ARMOUR = ['feet', 'legs', 'chest', 'head']
const OFF_HAND_SLOT = -106
const WORN = { feet: 'feet', legs: 'legs', chest: 'chest', head: 'head', offhand: 'off_hand' }

const plainName = name => String(name).replace(/^minecraft:/, '')

/** Return true if a stack has only a name and a count; a custom name or an enchantment is more. */
const isPlain = ({ tag, components }) => [tag, components].every(more => more === undefined || Object.keys(more).length === 0)

/**
 * Return the stacks of a list in the game's format.
 * @returns {{name: string, count: number, slot: number, isPlain: boolean}[]}
 */
function stacksIn (list = []) {
  return list.map(stack => ({
    name: plainName(stack.id ?? ''), count: stack.Count ?? stack.count ?? 1, slot: stack.Slot, isPlain: isPlain(stack)
  }))
}

/** Return ITEMS: the sum of the stacks by name. @returns {object} */
function totals (stacks) {
  // Names come from outside: an assignment to `__proto__` would set no item.
  const items = new Map()
  for (const { name, count } of stacks) items.set(name, (items.get(name) ?? 0) + count)
  return Object.fromEntries(items)
}

/**
 * Return the inventory and equipment of a player.
 * @param {object} data data of the entity: `Inventory`, since 1.21.5 also `equipment`
 * @param {number} selectedSlot selected slot of the hotbar
 * @returns {{inventory: object, equipment: object}}
 */
function possessionsIn ({ Inventory: own = [], equipment: worn = {} }, selectedSlot) {
  const stacks = stacksIn(own)
  const equipment = {}
  for (const { name, slot } of stacks) {
    if (slot === selectedSlot) equipment.main_hand = name
    if (slot === OFF_HAND_SLOT) equipment.off_hand = name
    if (ARMOUR[slot - FIRST_ARMOUR] !== undefined) equipment[ARMOUR[slot - FIRST_ARMOUR]] = name
  }
  for (const [part, slot] of Object.entries(WORN)) {
    if (worn[part]?.id === undefined) continue
    const [stack] = stacksIn([worn[part]])
    stacks.push(stack)
    equipment[slot] = stack.name
  }
  return { inventory: totals(stacks), equipment }
}

/**
 * Return the text of a chat component: a text, a list of components, or one followed by more in `extra`. What is nested
 * deeper than the game allows is left out.
 */
function textOf (component, depth = 0) {
  if (component === undefined || component === null || depth > DEEPEST) return ''
  if (Array.isArray(component)) return component.map(each => textOf(each, depth + 1)).join('')
  if (typeof component !== 'object') return String(component)
  return `${textOf(component.text ?? component[''], depth + 1)}${textOf(component.extra, depth + 1)}`
}

/**
 * Return the text of one line of a sign. Until 1.21.4 a line is a component as JSON; later versions store plain texts.
 */
function lineText (line) {
  if (typeof line !== 'string') return textOf(line)
  try {
    const component = JSON.parse(line)
    return ['string', 'object'].includes(typeof component) ? textOf(component) : line
  } catch (error) {
    if (error instanceof SyntaxError) return line
    throw error
  }
}

/** Return the text on the front of a sign, without empty lines at the end. @returns {string} */
function signTextIn (data) {
  const messages = data.front_text?.messages
  const lines = Array.isArray(messages) ? messages : Array.from({ length: LINES }, (_, index) => data[`Text${index + 1}`])
  return lines.map(lineText).join('\n').replace(/\n+$/, '')
}

module.exports = { plainName, possessionsIn, signTextIn, stacksIn, totals }
