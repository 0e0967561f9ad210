/** Time line below the pictures: scrubbing, playing, events and who perceived them, branches to jump to. */

import { badge, button, element, refill, seconds, svg } from './elements.js'
import { claimNoteOf, notesOf, verdictWords } from './notes.js'

const NEAR = 40
const LANES = 12
const TAIL = 12
const MOST_DOTS = 1500
const SPEEDS = [1, 2, 5, 20]

export class Clock {
  constructor (choose, play) {
    this.choose = choose
    this.slider = element('input', { type: 'range', min: '0', step: '1', 'aria-label': 'tick', oninput: () => this.seek(Number(this.slider.value)) })
    this.number = element('input', { type: 'number', class: 'tick', 'aria-label': 'tick', min: '0', onchange: () => this.seek(Number(this.number.value)) })
    this.time = element('span', { class: 'seconds' })
    this.playing = button('▶', 'play (space)', play, { class: 'play' })
    this.speed = element('select', { 'aria-label': 'speed' }, ...SPEEDS.map(each => element('option', { value: each }, `${each}×`)))
    this.branch = element('div', { class: 'lines', role: 'group', 'aria-label': 'branches' })
    this.lanes = element('div', { class: 'lanes' })
    this.events = element('ol', { class: 'events', 'aria-label': 'what happened' })
    this.element = element('section', { class: 'time', 'aria-label': 'time' },
      element('div', { class: 'controls' },
        button('«', 'event before (shift + left)', () => this.stepEvent(-1)), button('‹', 'tick before (left)', () => this.seek(this.tick - 1)),
        this.playing, button('›', 'tick after (right)', () => this.seek(this.tick + 1)), button('»', 'event after (shift + right)', () => this.stepEvent(1)),
        element('label', {}, 'tick ', this.number), this.time, this.speed, this.slider),
      element('div', { class: 'below' }, element('div', { class: 'left', tabindex: '0', role: 'region', 'aria-label': 'branches, and who perceived what' }, this.branch, this.lanes), this.events))
    this.shown = {}
  }

  draw (scene) {
    const { run, timeline, tick } = scene
    Object.assign(this, { run, timeline, tick })
    const { start, head } = timeline.facts
    for (const part of [this.slider, this.number]) {
      part.min = start
      part.max = head
    }
    if (document.activeElement !== this.number) this.number.value = tick
    this.slider.value = tick
    this.slider.setAttribute('aria-valuetext', `tick ${tick} of ${head}`)
    this.time.textContent = `${seconds(tick)} of ${seconds(head)}`
    this.listed = listed(run, timeline)
    this.drawBranches(scene)
    this.drawLanes(scene)
    this.drawEvents(scene)
  }

  setPlaying (on) {
    this.playing.textContent = on ? '❚❚' : '▶'
    this.playing.setAttribute('aria-pressed', String(on))
  }

  get ticksPerSecond () {
    return 20 * Number(this.speed.value)
  }

  seek (tick) {
    const { start, head } = this.timeline.facts
    if (Number.isFinite(tick)) this.choose({ tick: Math.max(start, Math.min(head, Math.round(tick))) })
  }

  stepEvent (direction) {
    const ticks = this.listed.map(each => each.t).filter(t => direction > 0 ? t > this.tick : t < this.tick)
    if (ticks.length) this.seek(direction > 0 ? ticks[0] : ticks.at(-1))
  }

  drawBranches ({ run, choice }) {
    const version = [run.number, choice.on, ...run.timelines.map(line => `${line.facts.start} ${line.facts.head}`)].join('|')
    if (version === this.shown.branches) return
    this.shown.branches = version
    const last = Math.max(1, ...run.timelines.map(line => line.facts.head))
    const depth = line => line.base ? 1 + depth(line.base) : 0
    this.branch.hidden = run.timelines.length < 2
    refill(this.branch, ...run.timelines.map(line => {
      const { path, branch, start, head } = line.facts
      const bar = element('span', { class: 'bar' })
      bar.style.left = `${100 * start / last}%`
      bar.style.width = `${Math.max(1, 100 * (head - start) / last)}%`
      return element('button', {
        type: 'button',
        class: `line${choice.on === line.number ? ' chosen' : ''}`,
        'aria-current': choice.on === line.number ? 'true' : null,
        onclick: () => this.choose({ on: line.number, at: path, beside: line.base ? '0 /' : '/', tick: Math.max(start, Math.min(head, this.tick)) })
      }, pathName('branch-name', `${path} ${branch}`, '· '.repeat(depth(line))), element('span', { class: 'rail' }, bar))
    }))
  }

  drawLanes ({ run, timeline, choice, track }) {
    const room = this.lanes.clientWidth
    const shown = this.listed.filter(each => each.number !== undefined)
    const paths = [...timeline.tracks.keys()].filter(path => path.split('/').length <= 3).slice(0, LANES)
    if (!paths.includes(track.path)) paths.push(track.path)
    const version = [run.number, timeline.number, room, shown.length, timeline.facts.head, paths.join(), choice.at].join('|')
    if (version !== this.shown.lanes) {
      this.shown.lanes = version
      refill(this.lanes, ...paths.map(path => this.lane(run, timeline, path, shown, choice, room)))
    }
    const { start, head } = timeline.facts
    const share = (this.tick - start) / Math.max(1, head - start)
    this.lanes.style.setProperty('--now', String(share))
  }

  lane (run, timeline, path, shown, choice, room) {
    const { start, head } = timeline.facts
    const track = timeline.track(path)
    const step = Math.max(1, Math.ceil(shown.length / MOST_DOTS))
    const width = Math.max(50, room - 130)
    const dots = shown.filter((_, number) => number % step === 0).map(each => {
      const look = run.head.agents.find(({ name }) => name === each.actor)
      const heard = track.heard.has(each.number)
      const x = 6 + (width - 12) * (each.t - start) / Math.max(1, head - start)
      return svg('circle', { cx: x, cy: 8, r: 4, class: heard ? 'heard' : 'missed', style: heard ? { fill: look?.colour ?? 'var(--quiet)' } : {}, onclick: () => this.choose({ tick: each.t, at: path }) },
        svg('title', {}, `tick ${each.t}: ${each.text} (${heard ? '' : 'not '}perceived in ${path})`))
    })
    return element('div', { class: `lane${choice.at === path ? ' chosen' : ''}` }, pathName('lane-name', path),
      svg('svg', { width, height: 16, role: 'img', 'aria-label': `${path}: perceived ${shown.filter(each => track.heard.has(each.number)).length} of ${shown.length} events` }, ...dots))
  }

  drawEvents ({ run, track, choice }) {
    let now = this.listed.findIndex(each => each.t > this.tick)
    if (now === -1) now = this.listed.length
    const near = this.listed.slice(Math.max(0, now - NEAR), now + NEAR)
    const version = [run.number, track.timeline.number, track.path, now, this.listed.length, choice.note].join('|')
    if (version === this.shown.events) return
    this.shown.events = version
    refill(this.events, ...near.map(each => this.event(run, track, each, choice)))
    const current = [...this.events.children].findLast(each => each.dataset.past === 'true')
    if (current) this.events.scrollTop = current.offsetTop - this.events.clientHeight / 2
  }

  event (run, track, each, choice) {
    const look = run.head.agents.find(({ name }) => name === each.actor)
    const heard = each.number === undefined || track.heard.has(each.number)
    const past = each.t <= this.tick
    const thing = each.at === undefined ? null : run.cell(each.at)
    const isContainer = thing !== null && track.timeline.tracks.get(track.timeline.facts.path)?.cells().includes(thing)
    const claims = (each.claims ?? []).map(([said, kind], index) => claimLine(said, kind, track.verdict(each.number, index)))
    const jump = { tick: each.t, note: each.note ?? null, ...(thing === null || thing < 0 ? {} : { thing: `${isContainer ? 'container' : 'block'}-${thing}` }) }
    return element('li', { 'data-past': String(past), class: `${heard ? '' : 'missed'}${each.t === this.tick ? ' now' : ''}` },
      element('button', { type: 'button', class: choice.note !== null && choice.note === each.note ? 'chosen' : '', onclick: () => this.choose(jump) },
        element('span', { class: 'when' }, each.t), look ? badge(look, { small: true }) : element('span', { class: 'nobody' }),
        element('span', { class: 'what' }, each.text, ...claims), heard ? null : element('span', { class: 'not' }, 'not perceived')))
  }
}

/** Return an element with a path. A long path is cut in its middle, because its end names the believing agent. */
function pathName (kind, path, before = '') {
  const tail = path.slice(-Math.min(TAIL, Math.floor(path.length / 2)))
  return element('span', { class: `${kind} cut`, title: path }, element('span', { class: 'head' }, `${before}${path.slice(0, path.length - tail.length)}`), element('span', { class: 'tail' }, tail))
}

function claimLine (said, kind, verdict) {
  const verdictText = verdictWords(verdict)
  return element('span', { class: 'claim' }, `claims: ${said}`, kind ? element('strong', { class: 'mark false' }, ` ${kind}`) : null, verdictText ? ` · ${verdictText}` : null)
}

/**
 * Return the listed events of a timeline and its notes, in order.
 * @returns {object[]}
 */
function listed (run, timeline) {
  const mark = `${timeline.events.length} ${run.programs.length} ${run.prompts.length}`
  if (timeline.listed?.mark !== mark) {
    const events = timeline.events.map((event, number) => ({ ...event, number, ...(event.claims ? { note: claimNoteOf(timeline, number) } : {}) })).filter(event => event.listed)
    timeline.listed = { mark, rows: [...events, ...notesOf(run, timeline)].sort((a, b) => a.t - b.t) }
  }
  return timeline.listed.rows
}
