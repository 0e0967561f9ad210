/** Tree of simulators: the recorded ones of every timeline, and controls to compute deeper ones. */

import { badge, button, element, refill } from './elements.js'

export class Tree {
  constructor (choose, deepen) {
    this.choose = choose
    this.deepen = deepen
    this.open = new Set()
    this.shown = null
    this.list = element('div', { class: 'branches' })
    this.note = element('p', { class: 'note', role: 'status', hidden: true })
    this.element = element('nav', { class: 'tree', 'aria-label': 'simulators' }, element('h2', {}, 'Simulators'), this.list, this.note)
  }

  tell (text) {
    this.note.textContent = text ?? ''
    this.note.hidden = !text
  }

  draw (run, choice, tick) {
    const marks = run.timelines.map(line => [...line.tracks.values()].map(track => track.wrong(shownTick(line, tick)).length).join()).join(';')
    const version = [run.number, choice.on, choice.at, marks, [...this.open].join(), run.timelines.map(line => line.facts.selected)].join('|')
    if (version === this.shown) return
    this.shown = version
    const focusedNode = document.activeElement?.dataset?.node
    refill(this.list, ...run.timelines.map(line => this.timeline(run, line, choice, tick)))
    if (focusedNode !== undefined) this.list.querySelector(`[data-node="${CSS.escape(focusedNode)}"]`)?.focus()
  }

  timeline (run, line, choice, tick) {
    const { path, branch, description } = line.facts
    const words = path === '/' ? (line.base === null ? 'The real world' : `The real world, branch “${branch}”`) : `${path}, branch “${branch}”`
    return element('section', { class: 'timeline' },
      element('h3', { title: description || null }, words),
      element('ul', {}, this.node(run, line, path, choice, tick)))
  }

  node (run, line, path, choice, tick) {
    const track = line.track(path)
    const key = `${line.number} ${path}`
    const below = [...line.tracks.keys()].filter(other => parentOf(other) === path && other !== path)
    const onWay = choice.on === line.number && (choice.at === path || choice.at.startsWith(path === '/' ? '/' : `${path}/`))
    const asked = line.number === 0 && run.head.asked.some(other => other === path || other.startsWith(path === '/' ? '/' : `${path}/`))
    const isOpen = this.open.has(key) !== (onWay || asked || path === line.facts.path)
    const row = element('div', { class: 'row' },
      below.length
        ? button(isOpen ? '▾' : '▸', `${isOpen ? 'hide' : 'show'} what is below ${path}`, () => this.toggle(key), { class: 'fold', 'aria-expanded': String(isOpen) })
        : element('span', { class: 'fold' }),
      this.name(run, line, track, choice, tick),
      button('+', `a simulator below ${path}`, () => this.toggle(`${key} more`), { class: 'more', 'aria-expanded': String(this.open.has(`${key} more`)) }))
    const item = element('li', {}, row)
    if (this.open.has(`${key} more`)) item.append(this.deeper(run, line, path, below))
    if (below.length && isOpen) item.append(element('ul', {}, ...below.map(other => this.node(run, line, other, choice, tick))))
    return item
  }

  name (run, line, track, choice, tick) {
    const { path } = track
    const chosen = choice.on === line.number && choice.at === path
    const owner = track.agents.at(-1)
    const look = run.head.agents.find(each => each.name === owner)
    const own = path === line.facts.path
    const count = track.wrong(shownTick(line, tick)).length
    const mode = own ? 'control' : 'follow'
    return element('button', {
      type: 'button',
      class: `node${chosen ? ' chosen' : ''}`,
      'aria-current': chosen ? 'true' : null,
      'data-node': `${line.number} ${path}`,
      title: `${path}: ${mode} mode${own ? `, branch “${line.facts.branch}”` : ''}, ${count} false`,
      onclick: () => this.choose({ on: line.number, at: path, beside: path === line.facts.path ? choice.beside : line.facts.path })
    },
    look ? badge(look, { small: true }) : null,
    element('span', { class: 'path' }, path === '/' ? 'reality' : owner),
    own ? element('span', { class: 'mode' }, line.facts.branch) : null,
    count ? element('span', { class: 'wrong', title: `${count} things are false` }, `${run.head.marks.false.sign} ${count}`) : null)
  }

  deeper (run, line, path, below) {
    const owner = path.split('/').at(-1)
    const there = new Set(below.map(other => other.split('/').at(-1)))
    const missing = run.head.agents.filter(({ name }) => name !== owner && !there.has(name))
    if (missing.length === 0) return element('p', { class: 'deeper' }, 'All agents are there.')
    return element('div', { class: 'deeper' }, 'What is believed of ', ...missing.map(look => button(
      look.name, `make ${path === '/' ? '' : path}/${look.name}`, () => this.deepen(line, `${path === '/' ? '' : path}/${look.name}`))))
  }

  toggle (key) {
    if (!this.open.delete(key)) this.open.add(key)
    this.again()
  }
}

/** Return the tick of a timeline that is shown while another timeline is chosen. @returns {number} */
export function shownTick (line, tick) {
  return Math.min(tick, line.facts.head)
}

function parentOf (path) {
  return path.slice(0, path.lastIndexOf('/')) || '/'
}
