/** Elements from data. Strings become text nodes, never markup. */

const SVG = 'http://www.w3.org/2000/svg'

export function element (tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children)
}

export function svg (tag, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, tag), attributes, children)
}

function filled (made, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value)
    else if (name === 'style') for (const [rule, setting] of Object.entries(value)) made.style.setProperty(rule, setting)
    else made.setAttribute(name, value === true ? '' : value)
  }
  made.append(...present(children))
  return made
}

function present (children) {
  return children.filter(child => child !== null && child !== undefined)
}

/** Replace an element's children; children that are null or undefined are left out. */
export function refill (parent, ...children) {
  parent.replaceChildren(...present(children))
}

/** Replace the options of a selection, each of which has a value and words. */
export function fillOptions (select, options, chosen) {
  refill(select, ...options.map(([value, words]) => element('option', { value, selected: value === chosen }, words)))
}

/** Return a button that shows a sign, with words for screen readers and as a tooltip. */
export function button (sign, words, onclick, attributes = {}) {
  return element('button', { type: 'button', title: words, 'aria-label': words, onclick, ...attributes }, sign)
}

/** Return an agent's disc. Letters and rings distinguish agents for readers who cannot distinguish the colours. */
export function badge (look, { small = false, ghost = false } = {}) {
  const made = element('span', { class: `badge${small ? ' small' : ''}${ghost ? ' ghost' : ''}`, 'aria-hidden': 'true' }, look.badge)
  made.style.background = look.colour
  made.style.color = look.ink
  if (look.rings > 0) made.style.boxShadow = `0 0 0 2px var(--ground), 0 0 0 ${2 + 2 * look.rings}px ${look.colour}`
  return made
}

export function seconds (ticks) {
  return `${(ticks / 20).toFixed(1)} s`
}

/** Return a number with its noun, such as "2 events". @returns {string} */
export function count (number, noun) {
  return number === 1 ? `1 ${noun}` : `${number} ${noun}s`
}

export function ago (ticks) {
  return `${count(ticks, 'tick')} ago`
}

export function itemsText (items) {
  return Object.entries(items).sort().map(([name, count]) => `${count} ${name.replaceAll('_', ' ')}`).join(', ')
}

export function pointText ({ x, y, z }) {
  return `(${[x, y, z].map(value => Number(value.toFixed(1))).join(', ')})`
}
