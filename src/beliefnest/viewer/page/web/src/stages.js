/** Pictures in the middle of the page: the chosen simulator, and another one beside it, with linked cameras. */

import { PerspectiveCamera, Vector3 } from 'three'
import { believesText } from './detail.js'
import { element, fillOptions, refill } from './elements.js'
import { Plan } from './floorPlan.js'
import { partToShow } from './part.js'
import { isWide } from './run.js'
import { Space, hasWebGL } from './space.js'
import { thingsOf } from './things.js'

const VIEWS = { space: '3D', plan: 'Plan', both: 'Both' }
const NARROW = 720
const BARS = 80
const HURRY_MS = 400
const LARGE = 200000
const VIEW = 42
const HALF_VIEW = Math.tan(VIEW / 360 * Math.PI)

export class Stages {
  constructor (choose) {
    this.choose = choose
    this.webgl = hasWebGL()
    this.camera = new PerspectiveCamera(VIEW, 1, 0.1, 2000)
    this.target = new Vector3()
    this.stages = [new Stage(this), new Stage(this)]
    this.views = element('div', { class: 'views', role: 'group', 'aria-label': 'how it is drawn' })
    this.sees = element('select', { onchange: event => choose({ sees: event.target.value || null }) })
    this.storey = element('select', { onchange: event => choose({ cut: event.target.value }) })
    this.other = element('select', { onchange: event => choose({ beside: event.target.value }) })
    this.bar = element('div', { class: 'bar-of-tools' }, this.views,
      element('label', {}, 'beside ', this.other), element('label', {}, 'sight of ', this.sees), element('label', {}, 'storey ', this.storey))
    this.element = element('section', { class: 'stages', 'aria-label': 'pictures' }, this.bar, element('div', { class: 'pair' }, ...this.stages.map(stage => stage.element)))
    this.aimed = null
    this.drawnAt = -Infinity
    this.hurried = false
  }

  /** Draw coarsely while pictures follow one another quickly; draw the last one again, sharply. */
  hurry () {
    const now = performance.now()
    this.hurried = now - this.drawnAt < HURRY_MS
    this.drawnAt = now
    clearTimeout(this.calming)
    if (this.hurried) this.calming = setTimeout(() => this.calm(), HURRY_MS)
  }

  calm () {
    this.hurried = false
    this.render()
  }

  render () {
    for (const stage of this.stages) if (!stage.element.hidden) stage.render(this.hurried)
  }

  draw (scene) {
    this.hurry()
    const wanted = scene.choice.view ?? (innerWidth < NARROW ? 'plan' : 'space')
    const view = this.webgl && VIEWS[wanted] ? wanted : 'plan'
    this.drawBar(scene, view)
    const { beside, run, track } = scene
    const two = beside !== null && beside !== track
    const second = two ? besideScene(scene) : null
    const part = this.aimed === run ? this.part : null
    this.part = partToShow(run, [scene.things, ...(two ? [second.things] : [])], part)
    this.aim(scene)
    this.stages[0].draw({ ...scene, part: this.part }, view)
    this.stages[1].element.hidden = !two
    if (two) this.stages[1].draw({ ...second, part: this.part }, view)
  }

  drawBar ({ run, timeline, choice, storey, beside, track }, view) {
    const options = [...timeline.tracks.keys()].map(path => [path, path])
    if (timeline.number !== 0) options.push(...[...run.timelines[0].tracks.keys()].map(path => [`0 ${path}`, `${path} (real run)`]))
    const version = [run.number, view, choice.sees, storey, choice.beside, track.path, timeline.number, options.length].join('|')
    if (version === this.shown) return
    this.shown = version
    const focusedView = document.activeElement?.dataset?.view
    refill(this.views, ...Object.entries(VIEWS).map(([name, words], number) => element('button', {
      type: 'button', 'data-view': name, 'aria-pressed': String(view === name), disabled: name !== 'plan' && !this.webgl,
      title: this.webgl ? `${words} (${number + 1})` : 'this browser has no WebGL', onclick: () => this.choose({ view: name })
    }, words)))
    if (focusedView) this.views.querySelector(`[data-view="${focusedView}"]`)?.focus()
    const chosen = beside === null ? 'none' : beside.timeline === timeline ? beside.path : `${beside.timeline.number} ${beside.path}`
    fillOptions(this.other, [['none', 'nothing'], ...options], chosen)
    fillOptions(this.sees, [['', 'nobody'], ...run.head.agents.map(({ name }) => [name, name])], choice.sees ?? '')
    const [low] = [run.head.box.low[1]]
    fillOptions(this.storey, Array.from({ length: run.shape[1] }, (_, n) => [String(low + n), String(low + n)]), String(storey))
  }

  /** Point the camera at a run once; afterwards only the user turns it. */
  aim ({ run, beside, track, things }) {
    if (this.aimed === run) return
    this.aimed = run
    const two = beside !== null && beside !== track
    const room = this.element.getBoundingClientRect()
    const aspect = Math.max(0.5, room.width / (two && innerWidth > NARROW ? 2 : 1) / Math.max(1, room.height - BARS))
    const { low: [left, back], size: [width, depth] } = this.part
    const { low } = run.head.box
    this.target.set(low[0] + left + width / 2, isWide(run) ? middleHeight(run, things) : low[1] + 1, low[2] + back + depth / 2)
    const far = Math.max(0.9 * depth + 3, (0.56 * width / (HALF_VIEW * aspect) + 0.35 * depth) / 1.2)
    this.camera.position.set(this.target.x, this.target.y + 0.92 * far, this.target.z + 0.78 * far)
    this.camera.lookAt(this.target)
  }

  moved () {
    this.turning ??= requestAnimationFrame(() => {
      this.turning = undefined
      this.hurry()
      this.render()
    })
  }
}

class Stage {
  constructor (stages) {
    this.stages = stages
    this.title = element('figcaption', {})
    this.holder = element('div', { class: 'holder' })
    this.plan = new Plan(stages.choose)
    this.element = element('figure', { class: 'stage' }, this.title, this.holder)
    this.view = null
  }

  draw (scene, view) {
    const { track, tick, things, run } = scene
    const count = things.wrong.size
    refill(this.title, element('strong', {}, believesText(track)), count ? element('span', { class: 'mark false' }, ` ${run.head.marks.false.sign} ${count} false`) : null,
      element('span', { class: 'path' }, ` ${track.path} `), element('span', { class: 'at' }, `tick ${tick}`))
    this.arrange(view, run.cells > LARGE)
    if (view !== 'space') this.plan.draw(scene)
    if (view !== 'plan') {
      this.space.hurried = this.stages.hurried
      this.space.draw(scene)
    }
  }

  render (hurried) {
    if (this.space === undefined) return
    this.space.hurried = hurried
    this.space.render()
  }

  arrange (view, isLarge) {
    if (view === this.view) return
    this.view = view
    if (view !== 'plan') this.space ??= new Space(this.stages.camera, this.stages.target, this.stages.choose, () => this.stages.moved(), isLarge)
    this.plan.drawn = null
    this.holder.className = `holder as-${view}`
    refill(this.holder, ...[view !== 'plan' ? this.space.element : null, view !== 'space' ? this.plan.element : null].filter(Boolean))
  }
}

/** Return the scene of the simulator that is shown beside the chosen one. */
function besideScene (scene) {
  const { beside, run } = scene
  const tick = Math.max(beside.timeline.facts.start, Math.min(beside.timeline.facts.head, scene.tick))
  return { ...scene, track: beside, tick, things: thingsOf(run, beside, tick), seen: null, seenVersion: '', ray: null }
}

/** Return the height in the middle of those at which things stand. @returns {number} */
function middleHeight (run, things) {
  const heights = [...things.containers.map(each => each.place[1]), ...things.agents.filter(each => each.pose !== null).map(each => each.pose.y)].sort((a, b) => a - b)
  return heights[Math.floor(heights.length / 2)] ?? run.head.box.low[1] + 1
}
