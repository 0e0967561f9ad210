/** Posterior about an agent over time: a click on a moment shows which movement changed which probability. */

import { element, refill, svg } from './elements.js'

const WIDTH = 220
const HIGH = 44
const DASHES = ['', '5 3', '2 2', '8 3']
const HEAT = '#4a1486'

/** Section with all posteriors of a run. */
export class Posterior {
  constructor (choose) {
    this.choose = choose
    this.element = element('section', { class: 'posterior', 'aria-label': 'inference', role: 'region', tabindex: '0', hidden: true })
    this.views = []
    this.run = null
  }

  draw ({ run, timeline, tick }) {
    if (this.run !== run.number) {
      this.run = run.number
      this.views = run.head.inferences.map((inference, number) => new PosteriorView(inference, number === 0, this.choose))
      refill(this.element, element('h2', {}, 'Inferred'), ...this.views.map(view => view.element))
    }
    this.element.hidden = this.views.length === 0 || timeline.number !== 0
    if (!this.element.hidden) this.views.forEach(view => view.draw(tick))
  }
}

/** One posterior; the plan is tinted by the first one of a run. */
class PosteriorView {
  constructor (inference, isTinted, choose) {
    Object.assign(this, { inference, isTinted, choose })
    this.about = element('p', { class: 'about' })
    this.panels = element('div', {})
    this.changes = element('ul', { class: 'changes', 'aria-label': 'what changed at this tick', 'aria-live': 'polite' })
    this.element = element('div', {}, ...inference.title ? [element('p', { class: 'title' }, element('strong', {}, inference.title))] : [], this.about, this.changes, this.panels)
    this.shown = null
  }

  draw (tick) {
    if (tick === this.shown) return
    this.shown = tick
    const { inference } = this
    const number = latest(inference.ticks, tick)
    refill(this.about, `Goals and beliefs of ${inference.agent}, inferred from what happened up to tick ${tick}.${this.isTinted ? ` The tint on the plan shows where ${inference.agent} will be after ${inference.steps} ${inference.steps === 1 ? 'action' : 'actions'}.` : ''}`)
    refill(this.changes, ...inference.changes.filter(([t]) => t === tick).map(([, text, factors]) => element('li', {},
      `${inference.agent} ${text}: `, element('strong', {}, factors.length ? factors.slice(0, 4).map(([name, bits]) => `${name} ${bits.toFixed(2)} bits`).join(', ') : 'changes nothing'))))
    refill(this.panels, ...inference.panels.map(panel => this.panel(inference, panel, number, tick)))
  }

  panel (inference, panel, number, tick) {
    const [first, last] = [inference.ticks[0], inference.ticks.at(-1) + 1]
    const x = t => WIDTH * (t - first) / (last - first)
    const y = value => HIGH * (panel.high - value) / (panel.high - panel.low)
    const pick = event => {
      const box = chart.getBoundingClientRect()
      this.choose({ tick: Math.min(last - 1, first + Math.floor((event.clientX - box.left) / box.width * (last - first))) })
    }
    const shapes = panel.stacked ? areas(inference, panel, last, x, y) : curves(inference, panel, last, x, y)
    const now = x(Math.max(first, Math.min(last - 1, tick)) + 0.5)
    const chart = svg('svg', { viewBox: `0 0 ${WIDTH} ${HIGH}`, preserveAspectRatio: 'none', role: 'img', 'aria-label': `${panel.title}, over time`, onclick: pick },
      ...shapes, svg('line', { class: 'now', x1: now, x2: now, y1: 0, y2: HIGH }))
    return element('figure', {}, element('h3', {}, panel.title), chart,
      element('ul', { class: 'legend' }, ...panel.series.map(([name, colour, values], at) => element('li', {}, swatch(panel, colour, at), ` ${name} `, element('strong', {}, worded(panel, values[Math.max(0, number)]))))))
  }
}

function swatch (panel, colour, at) {
  return svg('svg', { viewBox: '0 0 16 8', width: 16, height: 8, 'aria-hidden': 'true' }, panel.stacked
    ? svg('rect', { width: 16, height: 8, style: { fill: colour } })
    : svg('line', { x1: 0, x2: 16, y1: 4, y2: 4, 'stroke-width': 3, 'stroke-dasharray': DASHES[at % DASHES.length], style: { stroke: colour } }))
}

function worded (panel, value) {
  return panel.stacked ? `${Math.round(100 * value)} %` : String(Math.round(10 * value) / 10)
}

/** Return the corners of a curve that holds each value until the next tick. */
function steps (ticks, values, last, x, y) {
  return values.flatMap((value, at) => [[x(ticks[at]), y(value)], [x(ticks[at + 1] ?? last), y(value)]])
}

function curves ({ ticks }, panel, last, x, y) {
  return panel.series.map(([, colour, values], at) => svg('polyline', {
    class: 'curve', points: steps(ticks, values, last, x, y).join(' '), 'stroke-dasharray': DASHES[at % DASHES.length], style: { stroke: colour }
  }))
}

function areas ({ ticks }, panel, last, x, y) {
  let below = ticks.map(() => 0)
  return panel.series.map(([, colour, values]) => {
    const above = values.map((value, at) => below[at] + value)
    const points = [...steps(ticks, above, last, x, y), ...steps(ticks, below, last, x, y).reverse()]
    below = above
    return svg('polygon', { class: 'area', points: points.join(' '), style: { fill: colour } })
  })
}

/** Return the index of the last of some ticks at or before a tick, or -1. @returns {number} */
function latest (ticks, tick) {
  return ticks.findLastIndex(each => each <= tick)
}

/** Return squares on a plan, tinted by the root of the probability that the agent will be there. */
export function heatOf ({ run, timeline, tick }, at, size) {
  const inference = timeline.number === 0 ? run.head.inferences[0] : null
  const rows = inference ? inference.heats[latest(inference.heats.map(([t]) => t), tick)]?.[1] ?? [] : []
  return rows.map(([x, z, share]) => {
    const [left, top] = at(x, z)
    return svg('rect', { class: 'heat', x: left, y: top, width: size, height: size, style: { fill: HEAT, 'fill-opacity': 0.75 * Math.sqrt(share) } },
      svg('title', {}, `${inference.agent} will be here after ${inference.steps}: ${Math.round(100 * share)} %`))
  })
}
