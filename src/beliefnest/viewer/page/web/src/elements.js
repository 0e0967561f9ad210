/** Elements from data; texts are texts, whatever is in them. */

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
    else if (name === 'style') for (const [rule, told] of Object.entries(value)) made.style.setProperty(rule, told)
    else made.setAttribute(name, value === true ? '' : value)
  }
  made.append(...present(children))
  return made
}

function present (children) {
  return children.filter(child => child !== null && child !== undefined)
}

/** Put children, those that are there, in place of an element's own. */
export function refill (parent, ...children) {
  parent.replaceChildren(...present(children))
}

/** A button with words, or with a sign whose words are read aloud and shown when pointed at. */
export function button (sign, words, onclick, attributes = {}) {
  return element('button', { type: 'button', title: words, 'aria-label': words, onclick, ...attributes }, sign)
}

/** An agent's disc: its letters and rings tell it apart where colours do not. */
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

/** @returns {string} a number with its noun */
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
