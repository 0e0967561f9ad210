/** Entry point of the editor: a scenario file as a plan on which things are placed. */

import { badge, button, element, fillOptions, refill, svg } from './elements.js'
import { Plan } from './floorPlan.js'
import { wholeOf } from './part.js'
import { Run } from './run.js'
import { packedData } from './source.js'
import { mainStorey, thingsOf } from './things.js'

const root = document.getElementById('page')
const FACINGS = ['north', 'east', 'south', 'west']
const TOOLS = {
  wall: { words: 'wall', key: 'w', fields: { block: 'bricks' } },
  container: { words: 'box', key: 'b', fields: { container: 'chest', label: '', items: '' } },
  agent: { words: 'agent', key: 'a', fields: { agent: '', facing: FACINGS } },
  door: { words: 'door', key: 'd', fields: { door: 'oak', facing: FACINGS, open: false } },
  place: { words: 'place', key: 'p', fields: { place: '' } },
  sign: { words: 'sign', key: 's', fields: { sign: '' } },
  erase: { words: 'erase', key: 'e', fields: {} },
  look: { words: 'only look', key: 'l', fields: {} }
}
const FIELD_WORDS = { block: 'block', container: 'block', label: 'name', items: 'items', agent: 'name', facing: 'faces', door: 'wood', open: 'open', place: 'name', sign: 'text' }
const FIELD_HINTS = { items: 'diamond, 2 apple' }
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }
const WAIT_MS = 400

/** Editor of one file. The server computes every scene; the page keeps the text and its earlier versions. */
class Editor {
  constructor (begun) {
    this.begun = begun
    this.text = this.saved = begun.text
    if (begun.is_new) this.saved = null
    this.undone = []
    this.done = []
    this.viewer = null
    this.storey = null
    this.tool = 'wall'
    this.cursor = null
    this.turn = Promise.resolve()
    this.run = null
    this.build()
  }

  build () {
    this.plan = new Plan(() => {})
    this.plan.over.setAttribute('aria-hidden', 'true')
    this.plan.element.append(this.grid())
    this.status = element('p', { class: 'message', role: 'status', 'aria-live': 'polite', hidden: true })
    this.where = element('p', { class: 'where', 'aria-live': 'polite' }, '')
    this.tools = element('div', { class: 'tools', role: 'radiogroup', 'aria-label': 'tool' })
    this.fields = element('form', { class: 'fields', onsubmit: event => event.preventDefault() })
    this.sees = element('div', { class: 'sees' })
    this.source = element('textarea', { spellcheck: 'false', 'aria-label': 'text of the file', oninput: () => this.typed() })
    this.viewers = element('select', { onchange: event => { this.viewer = event.target.value || null; this.show() } })
    this.storeys = element('select', { onchange: event => { this.storey = Number(event.target.value); this.draw() } })
    this.undoing = button('↶', 'undo (Ctrl+Z)', () => this.back(this.done, this.undone))
    this.redoing = button('↷', 'redo (Ctrl+Y)', () => this.back(this.undone, this.done))
    this.saving = button('Save', 'save the file (Ctrl+S)', () => this.save(), { class: 'save' })
    const grow = side => button(`+ ${side}`, `add a ${side === 'east' ? 'column' : 'row'} in the ${side}`, () => this.edit({ do: 'grow', side }))
    refill(root,
      element('header', {}, element('h1', {}, this.begun.file), element('p', { class: 'subtitle' }, 'scenario editor'), this.undoing, this.redoing, this.saving),
      this.status,
      element('main', { class: 'middle editing' },
        element('section', { class: 'side', 'aria-label': 'tools' }, element('h2', {}, 'Place'), this.tools, this.fields,
          element('p', { class: 'hint' }, 'Click on the plan, or move with the arrow keys and press Enter. Delete erases.'), this.where),
        element('section', { class: 'stages', 'aria-label': 'plan' },
          element('div', { class: 'bar-of-tools' }, element('label', {}, 'sight of ', this.viewers), element('label', {}, 'storey ', this.storeys), grow('east'), grow('south')),
          element('div', { class: 'holder' }, this.plan.element)),
        element('section', { class: 'detail', 'aria-label': 'who sees what, and the file' }, element('h2', {}, 'Who sees what'), this.sees, element('h2', {}, 'File'), this.source)))
    addEventListener('keydown', event => this.key(event))
    addEventListener('beforeunload', event => { if (this.text !== this.saved) event.preventDefault() })
    new ResizeObserver(() => this.draw()).observe(this.plan.element)
    this.drawTools()
  }

  /** Return the layer that receives clicks and keys, above the plan. */
  grid () {
    this.mark = svg('rect', { class: 'cursor', hidden: true })
    this.touch = svg('svg', {
      class: 'touch',
      tabindex: '0',
      role: 'application',
      'aria-label': 'plan: arrow keys move, Enter places, Delete erases',
      onpointerdown: event => this.pressed(event),
      onpointermove: event => { if (event.buttons === 1 && ['wall', 'erase'].includes(this.tool)) this.pressed(event) },
      onkeydown: event => this.moved(event),
      onfocus: () => { this.cursor ??= [0, 0]; this.drawCursor() }
    }, this.mark)
    return this.touch
  }

  /** Ask the server for the scene of the text after an edit; requests follow one another. */
  show (edits = [], remember = true) {
    this.turn = this.turn.then(async () => {
      const before = this.text
      const scene = await asked('scene', { text: before, edits, viewer: this.viewer })
      if (scene.refused !== undefined) return this.tell(scene.refused)
      if (scene.text !== undefined && scene.text !== before) {
        if (remember) this.done.push(before)
        this.undone.length = 0
        this.text = scene.text
      }
      if (this.source.value !== this.text) this.source.value = this.text
      this.tell(scene.problem ?? '')
      if (scene.scene !== undefined) this.take(scene.scene)
      this.drawButtons()
    }).catch(error => this.tell(`The server does not answer (${error.message}).`))
    return this.turn
  }

  edit (edit) {
    return this.show([edit])
  }

  take (scene) {
    this.run = new Run()
    this.run.put(scene.run)
    this.scene = scene
    const { agents, box } = this.run.head
    if (!agents.some(({ name }) => name === this.viewer)) this.viewer = null
    const track = this.track
    const [low, high] = [box.low[1], box.low[1] + box.shape[1] - 1]
    if (this.storey === null || this.storey < low || this.storey > high) this.storey = mainStorey(this.run, track, 0)
    fillOptions(this.viewers, [['', 'nobody'], ...agents.map(({ name }) => [name, name])], this.viewer ?? '')
    fillOptions(this.storeys, Array.from({ length: box.shape[1] }, (_, n) => [String(low + n), String(low + n)]), String(this.storey))
    this.things = thingsOf(this.run, track, 0)
    this.drawSees()
    this.draw()
    document.documentElement.dataset.ready = 'true'
    document.documentElement.dataset.scene = String(Number(document.documentElement.dataset.scene ?? 0) + 1)
  }

  get track () {
    return this.run.timelines[0].track('/')
  }

  draw () {
    if (this.run === null) return
    const { seen } = this.scene
    this.plan.drawn = null
    this.plan.draw({
      run: this.run, part: wholeOf(this.run), timeline: this.run.timelines[0], track: this.track, tick: 0, things: this.things, storey: this.storey, seen, seenVersion: '', ray: null, chosen: null, named: true, dark: matchMedia('(prefers-color-scheme: dark)').matches
    })
    // Nothing on this plan is a button: the layer above it takes clicks and keys, and reads out what is there.
    for (const each of this.plan.over.querySelectorAll('.target')) for (const name of ['tabindex', 'role', 'aria-label']) each.removeAttribute(name)
    const [width, , depth] = this.run.shape
    const { size } = this.plan
    this.touch.setAttribute('viewBox', `0 0 ${width * size} ${depth * size}`)
    this.touch.style.width = `${width * size}px`
    this.touch.style.height = `${depth * size}px`
    refill(this.touch, ...this.places(), this.mark)
    this.drawCursor()
  }

  places () {
    const { size } = this.plan
    return (this.run.head.places ?? []).filter(([, y]) => y === this.storey).map(([x, , z, name]) => {
      const [left, top] = this.plan.at(x, z)
      return svg('g', { class: 'place' }, svg('rect', { x: left + 2, y: top + 2, width: size - 4, height: size - 4 }), svg('text', { x: left + size / 2, y: top + size / 2 + 4 }, name))
    })
  }

  drawCursor () {
    if (this.run === null || this.cursor === null) return
    const [width, , depth] = this.run.shape
    this.cursor = [Math.max(0, Math.min(width - 1, this.cursor[0])), Math.max(0, Math.min(depth - 1, this.cursor[1]))]
    const { size } = this.plan
    this.mark.removeAttribute('hidden')
    for (const [name, value] of Object.entries({ x: this.cursor[0] * size, y: this.cursor[1] * size, width: size, height: size })) this.mark.setAttribute(name, value)
    this.where.textContent = `${this.at.join(', ')}: ${this.here()}`
  }

  /** Return the position under the cursor. @returns {number[]} */
  get at () {
    const { low } = this.run.head.box
    return [low[0] + this.cursor[0], this.storey, low[2] + this.cursor[1]]
  }

  /** Return in words what is under the cursor. @returns {string} */
  here () {
    const cell = this.run.cell(this.at)
    const names = this.things.agents.filter(({ pose }) => pose !== null && this.run.cell([pose.x, pose.y + 0.01, pose.z]) === cell).map(({ look }) => look.name)
    names.push(...(this.run.head.places ?? []).filter(([x, y, z]) => this.run.cell([x, y, z]) === cell).map(each => each[3]))
    const block = this.run.states[this.track.grid(0)[cell]]
    if (!block.air || names.length === 0) names.push(this.run.label(this.at) ?? block.name.replaceAll('_', ' '))
    return names.join(', ')
  }

  pressed (event) {
    if (this.run === null) return
    const room = this.touch.getBoundingClientRect()
    const { size } = this.plan
    const cell = [Math.floor((event.clientX - room.left) / size), Math.floor((event.clientY - room.top) / size)]
    if (event.type === 'pointermove' && String(cell) === String(this.cursor)) return
    this.cursor = cell
    this.drawCursor()
    this.use(this.tool)
  }

  moved (event) {
    const step = STEPS[event.key]
    if (event.ctrlKey || event.metaKey || event.altKey || this.run === null) return
    if (step !== undefined) {
      this.cursor = [this.cursor[0] + step[0], this.cursor[1] + step[1]]
      this.drawCursor()
    } else if (event.key === 'Enter' || event.key === ' ') this.use(this.tool)
    else if (event.key === 'Delete' || event.key === 'Backspace') this.use('erase')
    else return
    event.preventDefault()
  }

  /** Apply a tool to the cell under the cursor. */
  use (tool) {
    if (tool === 'look') return
    if (tool === 'erase') return this.edit({ do: 'clear', at: this.at })
    const thing = this.thing(tool)
    if (thing === null) return
    return this.edit({ do: 'put', at: this.at, thing })
  }

  /** Return what a tool places, as in the legend of a map; null if a field is missing. */
  thing (tool) {
    const fields = {}
    for (const [name, value] of new FormData(this.fields)) if (value !== '') fields[name] = value
    if (tool === 'wall') return fields.block ?? null
    const [first] = Object.keys(TOOLS[tool].fields)
    if (fields[first] === undefined) {
      this.tell(`Fill in the ${FIELD_WORDS[first]} of the ${TOOLS[tool].words} first.`)
      this.fields.elements[first].focus()
      return null
    }
    if (fields.items !== undefined) fields.items = itemsOf(fields.items)
    if (fields.open !== undefined) fields.open = true
    return fields
  }

  drawTools () {
    const hadFocus = this.tools.contains(document.activeElement)
    refill(this.tools, ...Object.entries(TOOLS).map(([name, { words, key }]) => element('button', {
      type: 'button', role: 'radio', 'aria-checked': String(name === this.tool), tabindex: name === this.tool ? '0' : '-1', 'data-tool': name, title: `${words} (${key})`, onclick: () => this.choose(name), onkeydown: event => this.nextTool(event)
    }, words)))
    if (hadFocus) this.tools.querySelector('[aria-checked=true]').focus()
    const lists = ['block', 'container', 'door'].includes(Object.keys(TOOLS[this.tool].fields)[0]) ? [this.names()] : []
    refill(this.fields, ...Object.entries(TOOLS[this.tool].fields).map(([name, value]) => this.field(name, value)), ...lists)
  }

  names () {
    const { blocks } = this.begun
    const names = this.tool === 'door' ? blocks.filter(name => name.endsWith('_door')).map(name => name.slice(0, -5)) : blocks
    return element('datalist', { id: 'names' }, ...names.map(name => element('option', { value: name })))
  }

  field (name, value) {
    const words = FIELD_WORDS[name]
    if (Array.isArray(value)) {
      const options = this.tool === 'door' ? ['', ...value] : value
      return element('label', {}, `${words} `, element('select', { name }, ...options.map(each => element('option', { value: each }, each || 'across its wall'))))
    }
    if (typeof value === 'boolean') return element('label', {}, element('input', { type: 'checkbox', name, checked: value }), ` ${words}`)
    const list = ['block', 'container', 'door'].includes(name) ? 'names' : null
    return element('label', {}, `${words} `, element('input', { name, value, list, autocomplete: 'off', placeholder: FIELD_HINTS[name] ?? null }))
  }

  choose (tool) {
    this.tool = tool
    this.drawTools()
  }

  nextTool (event) {
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key]
    if (step === undefined) return
    event.preventDefault()
    const names = Object.keys(TOOLS)
    this.choose(names[(names.indexOf(this.tool) + step + names.length) % names.length])
  }

  drawSees () {
    const { agents } = this.run.head
    const things = [...this.things.agents.map(({ thing, look }) => [thing, look.name]), ...this.things.containers.map(({ thing, name }) => [thing, name])]
    refill(this.sees, element('table', {},
      element('thead', {}, element('tr', {}, element('td', {}), ...agents.map(look => element('th', { scope: 'col' }, badge(look, { small: true }), element('span', { class: 'hidden-words' }, look.name))))),
      element('tbody', {}, ...things.map(([thing, name]) => element('tr', {}, element('th', { scope: 'row' }, name), ...agents.map((look, number) => {
        const own = thing === `agent-${number}`
        const seen = this.scene.sees[look.name].includes(thing)
        return element('td', { 'data-sees': own ? null : `${look.name} ${name}`, class: seen ? 'seen' : 'unseen' }, own ? '' : seen ? 'sees' : '–')
      }))))))
  }

  drawButtons () {
    this.undoing.disabled = this.done.length === 0
    this.redoing.disabled = this.undone.length === 0
    this.saving.disabled = this.text === this.saved
    document.title = `${this.text === this.saved ? '' : '• '}${this.begun.file}`
  }

  /** Go to the newest text of one list; the present text goes to the other. */
  back (from, to) {
    if (from.length === 0) return
    to.push(this.text)
    this.text = from.pop()
    this.show()
  }

  typed () {
    clearTimeout(this.waiting)
    this.waiting = setTimeout(() => {
      if (this.source.value === this.text) return
      this.done.push(this.text)
      this.undone.length = 0
      this.text = this.source.value
      this.show()
    }, WAIT_MS)
  }

  async save () {
    await this.turn
    if (this.source.value !== this.text) this.text = this.source.value
    const text = this.text
    try {
      const outcome = await asked('save', { text })
      if (outcome.problem !== undefined) return this.tell(outcome.problem)
      this.saved = text
      this.tell(`${outcome.saved} is saved.`)
    } catch (error) {
      this.tell(`The server does not answer (${error.message}).`)
    }
    this.drawButtons()
  }

  key (event) {
    const letter = event.key.toLowerCase()
    if (event.ctrlKey || event.metaKey) {
      if (letter === 's') this.save()
      else if (event.target === this.source) return
      else if (letter === 'z' && !event.shiftKey) this.back(this.done, this.undone)
      else if (letter === 'y' || (letter === 'z' && event.shiftKey)) this.back(this.undone, this.done)
      else return
      event.preventDefault()
      return
    }
    if (event.altKey || event.target.closest('input, select, textarea')) return
    const [name] = Object.entries(TOOLS).find(([, { key }]) => key === letter) ?? []
    if (name !== undefined) this.choose(name)
  }

  tell (text) {
    this.status.textContent = text
    this.status.hidden = !text
  }
}

/** Return counts by item of a text such as "diamond, 2 apple". @returns {object} */
function itemsOf (text) {
  const counts = {}
  for (const part of text.split(',').map(each => each.trim()).filter(Boolean)) {
    const [, number, name] = /^(?:(\d+)\s+)?(.*)$/.exec(part)
    counts[name.trim().replaceAll(' ', '_')] = Number(number ?? 1)
  }
  return counts
}

async function asked (what, content) {
  const response = await fetch(`api/${what}`, {
    method: 'POST', credentials: 'same-origin', headers: { 'content-type': 'application/json' }, body: JSON.stringify(content)
  })
  return await response.json()
}

async function begin () {
  const { content } = await packedData(document.getElementById('data'))
  if (location.search) history.replaceState(null, '', location.pathname + location.hash)
  const editor = new Editor(content)
  await editor.show()
  editor.drawButtons()
  // A file with an error has no scene yet; its text can be mended.
  document.documentElement.dataset.ready = 'true'
}

begin().catch(error => {
  refill(root, element('p', { class: 'failed', role: 'alert' }, `This page cannot be shown: ${error.message}`))
})
