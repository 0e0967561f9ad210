'use strict'
/** What the game's own data says of things held and words written, as files and `/data` give it, across its versions. */

const LINES = 4
const FIRST_ARMOUR = 100
const ARMOUR = ['feet', 'legs', 'chest', 'head']
const OFF_HAND_SLOT = -106
const WORN = { feet: 'feet', legs: 'legs', chest: 'chest', head: 'head', offhand: 'off_hand' }

const plainName = name => String(name).replace(/^minecraft:/, '')

/** Whether a stack has more to it than name and count, as a name of its own or an enchantment. */
const isPlain = ({ tag, components }) => [tag, components].every(more => more === undefined || Object.keys(more).length === 0)

/** @returns {{name: string, count: number, slot: number, isPlain: boolean}[]} stacks of a list of the game's data */
function stacksIn (list = []) {
  return list.map(stack => ({
    name: plainName(stack.id), count: stack.Count ?? stack.count ?? 1, slot: stack.Slot, isPlain: isPlain(stack)
  }))
}

/** @returns {object} ITEMS */
function totals (stacks) {
  const items = {}
  for (const { name, count } of stacks) items[name] = (items[name] ?? 0) + count
  return items
}

/**
 * What somebody has.
 * @param {object} data of an entity: `Inventory`, since 1.21.5 `equipment` besides
 * @param {number} held slot of the hotbar
 * @returns {{inventory: object, equipment: object}}
 */
function possessionsIn ({ Inventory: own = [], equipment: worn = {} }, held) {
  const stacks = stacksIn(own)
  const equipment = {}
  for (const { name, slot } of stacks) {
    if (slot === held) equipment.main_hand = name
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

/** The text of a component: a text, a list of components, or one with more of them after it. */
function textOf (component) {
  if (component === undefined || component === null) return ''
  if (Array.isArray(component)) return component.map(textOf).join('')
  if (typeof component !== 'object') return String(component)
  return `${component.text ?? component[''] ?? ''}${textOf(component.extra)}`
}

/** A line of a sign. Until 1.21.4 it is a component as JSON; since then a plain text is written as it is. */
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

/** @returns {string} what is written on the front of a sign, without empty lines at the end */
function signTextIn (data) {
  const lines = data.front_text?.messages ?? Array.from({ length: LINES }, (_, index) => data[`Text${index + 1}`])
  return lines.map(lineText).join('\n').replace(/\n+$/, '')
}

module.exports = { plainName, possessionsIn, signTextIn, stacksIn, totals }
