/** Parts of the page, and how they are drawn together. */

import { Clock } from './clock.js'
import { Detail } from './detail.js'
import { badge, button, element, refill } from './elements.js'
import { noteNamed } from './notes.js'
import { Posterior } from './posterior.js'
import { rayOf } from './ray.js'
import { Rounds } from './rounds.js'
import { partsOf } from './run.js'
import { Stages } from './stages.js'
import { mainStorey, thingsOf } from './things.js'
import { Tree } from './tree.js'

const STEPS = { ArrowLeft: -1, ArrowRight: 1 }

export class App {
  constructor (root, runs, chooser, source) {
    Object.assign(this, { runs, chooser, source })
    const choose = changes => chooser.set(changes)
    this.tree = new Tree(choose, (line, path) => this.deepen(line, path))
    this.tree.again = () => this.draw()
    this.rounds = new Rounds(choose)
    this.posterior = new Posterior(choose)
    this.stages = new Stages(choose)
    this.detail = new Detail(choose, source)
    this.clock = new Clock(choose, () => this.play())
    this.message = element('p', { class: 'message', role: 'status', hidden: true })
    this.header = element('header', {})
    refill(root, this.header, this.message, element('main', { class: 'middle' }, element('div', { class: 'side' }, this.tree.element, this.rounds.element, this.posterior.element), this.stages.element, this.detail.element, this.clock.element))
    chooser.listeners.push((_, changes) => { if ('tick' in changes) this.atEnd = false; this.later() })
    new ResizeObserver(() => this.later()).observe(this.stages.element)
    addEventListener('keydown', event => this.key(event))
    this.atEnd = source.live && chooser.choice.tick === null
    this.drawHeader()
  }

  /** Draw in the browser's next animation frame, at most once per frame. */
  later () {
    this.due ??= requestAnimationFrame(() => {
      this.due = undefined
      this.draw()
    })
  }

  tell (text) {
    this.message.textContent = text
    this.message.hidden = !text
  }

  draw () {
    const scene = this.scene()
    this.drawHeader()
    this.tree.draw(scene.run, { ...scene.choice, on: scene.timeline.number, at: scene.track.path }, scene.tick)
    this.rounds.draw(scene)
    this.posterior.draw(scene)
    this.stages.draw(scene)
    this.detail.draw(scene)
    this.clock.draw(scene)
  }

  /**
   * Return the current selection with defaults in place of missing parts; an address may name things that no longer
   * exist.
   * @returns {object}
   */
  scene () {
    const choice = this.chooser.choice
    const run = this.runs[choice.run] ?? this.runs[0]
    const timeline = run.timelines[choice.on] ?? run.timelines[0]
    const track = timeline.track(choice.at) ?? timeline.track(timeline.facts.path)
    const { start, head } = timeline.facts
    const tick = choice.tick === null ? head : Math.max(start, Math.min(head, choice.tick))
    const beside = this.beside(run, timeline, choice)
    const viewer = run.head.agents.findIndex(each => each.name === choice.sees)
    const scene = { choice, run, timeline, track, tick, beside, viewer: viewer < 0 ? null : viewer, chosen: choice.thing, noted: noteNamed(run, choice.note) }
    scene.things = thingsOf(run, track, tick)
    scene.storey = choice.cut === null ? mainStorey(run, timeline.track(timeline.facts.path), tick) : Number(choice.cut)
    scene.dark = this.dark
    return Object.assign(scene, this.view(scene, track, tick))
  }

  /** Return the blocks that an agent sees in a track, and its line of sight to the chosen thing. */
  view ({ run, viewer, chosen }, track, tick) {
    if (viewer === null) return { look: null, seen: null, seenVersion: '', ray: null }
    const runs = this.source.sight(run, track, tick, viewer)
    const judged = chosen !== null && partsOf(chosen).kind !== 'inventory' && chosen !== `agent-${viewer}`
    const look = judged ? this.source.look(run, track, tick, viewer, chosen) : null
    return { look, ...this.seenCells(runs, run), ray: rayOf(run, track, tick, viewer, judged ? chosen : null, look) }
  }

  /** Return a flag for each cell, and a text that stays the same as long as no flag changes. */
  seenCells (lengths, run) {
    if (this.seenOf?.lengths !== lengths || this.seenOf.run !== run) {
      this.seenOf = { lengths, run, flags: flags(lengths, run), number: (this.seenOf?.number ?? 0) + 1 }
    }
    return { seen: this.seenOf.flags, seenVersion: String(this.seenOf.number) }
  }

  beside (run, timeline, { beside }) {
    if (beside === 'none') return null
    const [first, second] = beside.split(' ')
    const track = second === undefined ? timeline.track(first) : run.timelines[first]?.track(second)
    return track ?? timeline.track(timeline.facts.path) ?? null
  }

  get dark () {
    const wanted = document.documentElement.dataset.theme
    return wanted ? wanted === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches
  }

  drawHeader () {
    const run = this.runs[this.chooser.choice.run] ?? this.runs[0]
    const version = `${run.number} ${this.chooser.choice.sees} ${this.dark}`
    if (this.headed === version) return
    this.headed = version
    const { title, subtitle, description, agents, marks } = run.head
    refill(this.header,
      element('h1', {}, title),
      this.runs.length > 1 ? this.runChooser() : null,
      element('p', { class: 'subtitle' }, this.runs.length > 1 ? description : subtitle || description),
      element('ul', { class: 'legend', 'aria-label': 'agents and marks' },
        ...agents.map(look => element('li', {}, badge(look, { small: true }), ` ${look.name}`)),
        ...Object.entries(marks).filter(([, mark]) => mark.sign).map(([name, mark]) => element('li', { title: mark.words }, element('span', { class: `mark ${name}` }, mark.sign), ` ${name}`))),
      button('◐', 'dark or light', () => this.turnTheme(), { class: 'theme' }))
    document.title = [title, subtitle].filter(Boolean).join(': ')
  }

  runChooser () {
    const options = this.runs.map(run => element('option', { value: run.number, selected: run.number === this.chooser.choice.run }, run.head.subtitle || `${run.head.title} ${run.number + 1}`))
    return element('select', { class: 'runs', 'aria-label': 'run', onchange: event => this.chooser.set({ run: Number(event.target.value), on: 0, thing: null, note: null, tick: null }) }, ...options)
  }

  turnTheme () {
    document.documentElement.dataset.theme = this.dark ? 'light' : 'dark'
    this.later()
  }

  async deepen (line, path) {
    const run = this.scene().run
    this.tree.tell('Working it out …')
    try {
      const problem = await this.source.deepen(run, line, path)
      this.tree.tell(problem)
      if (problem === null) {
        this.waitingFor = { run: run.number, on: line.number, at: path }
        this.grown(run.number)
      }
    } catch (error) {
      this.tree.tell(`The server does not answer (${error.message}).`)
    }
  }

  /** Show the new part of a run that has grown: move on if its end was shown, and go to the requested place. */
  grown (number) {
    const wanted = this.waitingFor
    if (wanted && this.runs[wanted.run].timelines[wanted.on]?.track(wanted.at)) {
      this.waitingFor = null
      this.tree.tell('')
      this.chooser.set(wanted)
    }
    if (number === this.chooser.choice.run) this.later()
  }

  play () {
    if (this.playing) return this.stop()
    const { timeline, tick } = this.scene()
    const { start, head } = timeline.facts
    const first = tick >= head ? start : tick
    const began = performance.now()
    this.playing = true
    this.clock.setPlaying(true)
    const go = now => {
      if (!this.playing) return
      const next = Math.min(head, Math.floor(first + (now - began) / 1000 * this.clock.ticksPerSecond))
      if (next !== this.chooser.choice.tick) this.chooser.set({ tick: next })
      if (next >= head) this.stop()
      else requestAnimationFrame(go)
    }
    requestAnimationFrame(go)
  }

  stop () {
    this.playing = false
    this.clock.setPlaying(false)
  }

  key (event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest('input, select, textarea, pre')) return
    if (event.key === ' ' && !event.target.closest('button, [role=button]')) this.play()
    else if (STEPS[event.key] && event.shiftKey) this.clock.stepEvent(STEPS[event.key])
    else if (STEPS[event.key]) this.clock.seek(this.scene().tick + STEPS[event.key])
    else if (event.key === 'Home') this.clock.seek(this.scene().timeline.facts.start)
    else if (event.key === 'End') this.clock.seek(this.scene().timeline.facts.head)
    else if (event.key === 'Escape') this.chooser.set({ thing: null, note: null })
    else if ('123'.includes(event.key)) this.chooser.set({ view: ['space', 'plan', 'both'][Number(event.key) - 1] })
    else return
    event.preventDefault()
  }
}

function flags (runs, run) {
  if (runs === null) return null
  const [width, height, depth] = run.shape
  const seen = new Uint8Array(width * height * depth)
  let from = 0
  runs.forEach((length, number) => {
    if (number % 2 === 1) seen.fill(1, from, from + length)
    from += length
  })
  return seen
}
