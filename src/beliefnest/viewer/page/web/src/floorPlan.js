/** Simulator from above: blocks on a canvas, and clickable shapes on top of it. */

import { element, refill, svg } from './elements.js'
import { apart } from './labels.js'
import { heatOf } from './posterior.js'
import { paintRelief } from './relief.js'
import { isWide } from './run.js'
import { contentsLabel, contentsText, memoryWords, shortened, signsText } from './things.js'

const LIGHT = { wall: '#7d7a78', nowhere: '#d9d5cc', unknown: '#eeeae2', hatch: '#b9b4aa', unseen: 'rgba(43,42,51,.30)', blend: '#fcfbf8' }
const DARK = { wall: '#9a979c', nowhere: '#17161b', unknown: '#2b2930', hatch: '#56525e', unseen: 'rgba(0,0,0,.55)', blend: '#24232a' }
const LEAST = 6
const LEAST_WIDE = 0.75
const LEAST_SIGN = 6
const LETTER = 7
const BOLD = 7.6
const RING = 1.4
const LINE = 14

/** Plan of a simulator, drawn into an element that it fills. */
export class Plan {
  constructor (choose) {
    this.choose = choose
    this.canvas = element('canvas', { 'aria-hidden': 'true' })
    this.over = svg('svg', { class: 'over', role: 'group', 'aria-label': 'plan' })
    this.element = element('div', { class: 'plan' }, this.canvas, this.over)
    this.drawn = null
  }

  /**
   * Draw a scene.
   * @param {object} scene - run, part, track, tick, things, storey, seen (Uint8Array or null), ray, chosen, dark, and `named` to name containers
   */
  draw (scene) {
    const { run, part } = scene
    const [width, depth] = part.size
    const room = this.element.getBoundingClientRect()
    this.size = Math.max(isWide(run) ? LEAST_WIDE : LEAST, Math.min(room.width / width, room.height / depth))
    const { low } = run.head.box
    this.low = [low[0] + part.low[0], low[1], low[2] + part.low[1]]
    this.drawBlocks(scene, width, depth)
    const [w, d] = [width * this.size, depth * this.size]
    this.over.setAttribute('viewBox', `0 0 ${w} ${d}`)
    for (const part of [this.canvas, this.over]) {
      part.style.width = `${w}px`
      part.style.height = `${d}px`
    }
    this.labelled = this.discs(scene)
    refill(this.over,
      ...heatOf(scene, (x, z) => this.at(x, z), this.size), ...this.wrongBlocks(scene), ...this.ray(scene), ...this.containers(scene), ...this.signs(scene), ...this.items(scene), ...this.agents(scene))
  }

  drawBlocks (scene, width, depth) {
    const { run, part, track, tick, storey, seen, dark } = scene
    const version = `${track.gridVersion(tick)} ${storey} ${this.size} ${this.low} ${dark} ${scene.seenVersion}`
    if (version === this.drawn) return
    this.drawn = version
    const scale = Math.min(2, devicePixelRatio || 1) * this.size
    this.canvas.width = Math.round(width * scale)
    this.canvas.height = Math.round(depth * scale)
    const paint = this.canvas.getContext('2d')
    const tones = dark ? DARK : LIGHT
    const grid = track.grid(tick)
    const layer = storey - run.head.box.low[1]
    const height = run.shape[1]
    if (isWide(run)) {
      const image = paint.createImageData(width, depth)
      paintRelief(image, { run, part, grid, layer, seen }, tones)
      return this.putImage(paint, image)
    }
    for (let i = 0; i < width; i++) {
      for (let k = 0; k < depth; k++) {
        const cell = (i * height + layer) * depth + k
        const below = layer > 0 ? grid[cell - depth] : undefined
        paintCell(paint, run, [i, k, scale], grid[cell], below, tones)
        if (seen !== null && !seen[cell]) fill(paint, [i, k, scale], tones.unseen)
      }
    }
  }

  /** Paint an image with a pixel for each column over the whole canvas. */
  putImage (paint, image) {
    const small = element('canvas', { width: image.width, height: image.height })
    small.getContext('2d').putImageData(image, 0, 0)
    paint.imageSmoothingEnabled = false
    paint.drawImage(small, 0, 0, this.canvas.width, this.canvas.height)
  }

  /** Return the corner and the size of a square around a column that is large enough to be seen. @returns {number[]} */
  squareAt ([x, , z]) {
    const [left, top] = this.at(x, z)
    const size = Math.max(LEAST_SIGN, this.size)
    return [left - (size - this.size) / 2, top - (size - this.size) / 2, size]
  }

  /** Return where a point of the world lies on the plan. @returns {number[]} */
  at (x, z) {
    return [(x - this.low[0]) * this.size, (z - this.low[2]) * this.size]
  }

  /** Return the boxes that agents take on the plan; no text may lie on them. */
  discs ({ things }) {
    const r = this.radius()
    return things.agents.filter(each => each.pose !== null).map(({ pose }) => {
      const [x, y] = this.at(pose.x, pose.z)
      // The ring around the agent is wider than its disc; the agent's own name begins just below it.
      return { left: x - RING * r, top: y - r, width: 2 * RING * r, height: 2 * r - 1 }
    })
  }

  radius () {
    return Math.max(7, 0.42 * this.size)
  }

  /** Return a text near a thing, moved up or down if it would overlap another one. */
  label (x, y, text, wrong) {
    const width = (wrong ? BOLD : LETTER) * text.length
    const free = apart(this.labelled, { left: x - width / 2, top: y - LINE, width, height: LINE })
    this.labelled.push(free)
    return svg('text', { class: `label${wrong ? ' false' : ''}`, x, y: free.top + LINE }, text)
  }

  target (thing, words, chosen, ...parts) {
    const pick = event => { event.stopPropagation(); this.choose({ thing, note: null }) }
    return svg('g', {
      class: `target${chosen === thing ? ' chosen' : ''}`,
      tabindex: '0',
      role: 'button',
      'aria-label': words,
      'data-thing': thing,
      onclick: pick,
      onkeydown: event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); pick(event) } }
    }, svg('title', {}, words), ...parts)
  }

  containers ({ run, things, chosen, storey, named = false }) {
    return things.containers.filter(each => isOn(run, each, storey) && (each.contents || each.marks.length)).map(each => {
      const [x, y, s] = this.squareAt(each.place)
      const name = named ? run.label(each.place) : null
      const contentText = [contentsLabel(each.contents), signsText(run, each.marks, each.age)].filter(Boolean).join(' ')
      const text = name === null ? contentText : `${name}: ${contentText}`
      const words = `${each.name}: ${contentsText(each.contents)}${each.marks.length ? ` (${each.marks.join(', ')})` : ''}`
      const wrong = each.marks.includes('false')
      return this.target(each.thing, words, chosen,
        svg('rect', { class: `box${each.contents === null ? ' unsure' : ''}`, x: x + 0.08 * s, y: y + 0.12 * s, width: 0.84 * s, height: 0.76 * s, rx: 0.12 * s }),
        svg('line', { class: 'lid', x1: x + 0.08 * s, x2: x + 0.92 * s, y1: y + 0.42 * s, y2: y + 0.42 * s }),
        wrong ? svg('rect', { class: 'wrong', x, y, width: s, height: s, rx: 0.16 * s }) : null,
        this.label(x + s / 2, y - 5, text, wrong))
    })
  }

  signs ({ run, things, chosen, storey }) {
    return things.signs.filter(each => isOn(run, each, storey)).map(each => {
      const [x, y, s] = this.squareAt(each.place)
      const wrong = each.marks.includes('false')
      return this.target(each.thing, `${each.name} says “${each.says}”${wrong ? ' (false)' : ''}`, chosen,
        svg('rect', { class: 'board', x: x + 0.1 * s, y: y + 0.3 * s, width: 0.8 * s, height: 0.4 * s, rx: 0.06 * s }),
        svg('line', { class: 'lid', x1: x + 0.22 * s, x2: x + 0.78 * s, y1: y + 0.5 * s, y2: y + 0.5 * s }),
        this.label(x + s / 2, y - 2, `“${shortened(each.says)}”`, wrong))
    })
  }

  agents ({ run, things, chosen, storey }) {
    return things.agents.filter(each => each.pose !== null).map(each => {
      const { pose, look } = each
      const [x, y] = this.at(pose.x, pose.z)
      const r = this.radius()
      const [dx, dy] = [-Math.sin(pose.yaw), -Math.cos(pose.yaw)]
      const far = !isWide(run) && Math.abs(pose.y - storey) > 1.5
      const wrong = each.marks.includes('false')
      const sign = signsText(run, each.marks, each.age)
      const when = pose.current ? '' : `, ${memoryWords(pose, each.age)}`
      const side = [-dy * 0.55 * r, dx * 0.55 * r]
      const nose = [[x + dx * 1.55 * r, y + dy * 1.55 * r], [x + dx * 0.7 * r + side[0], y + dy * 0.7 * r + side[1]],
        [x + dx * 0.7 * r - side[0], y + dy * 0.7 * r - side[1]]]
      return this.target(each.thing, `${look.name}${when}${wrong ? ', false' : ''}`, chosen,
        svg('polygon', { points: nose.map(point => point.join()).join(' '), style: { fill: look.colour } }),
        ...Array.from({ length: look.rings }, (_, n) => svg('circle', { class: 'ring', cx: x, cy: y, r: r + 2 + 3 * n, style: { stroke: look.colour } })),
        svg('circle', { class: `disc${pose.current ? '' : ' stale'}${far ? ' far' : ''}`, cx: x, cy: y, r, style: { fill: look.colour } }),
        wrong ? svg('circle', { class: 'wrong', cx: x, cy: y, r: r + 4 }) : null,
        svg('text', { class: 'letters', x, y, style: { fill: look.ink, 'font-size': `${Math.max(9, 0.9 * r)}px` } }, look.badge),
        this.label(x, y + r + 14, [look.name, sign].filter(Boolean).join(' '), wrong))
    })
  }

  items ({ things }) {
    return things.items.map(([name, count, x, , z]) => {
      const [left, top] = this.at(x, z)
      const r = 0.14 * this.size
      return svg('g', { class: 'lying' }, svg('title', {}, `${count} ${name} on the ground`),
        svg('rect', { x: left - r, y: top - r, width: 2 * r, height: 2 * r, transform: `rotate(45 ${left} ${top})` }))
    })
  }

  wrongBlocks ({ run, things, storey, chosen }) {
    return things.wrongBlocks.filter(cell => run.place(cell)[1] === storey).slice(0, 200).map(cell => {
      const [x, , z] = run.place(cell)
      const [left, top] = this.at(x, z)
      return this.target(`block-${cell}`, `block at ${run.place(cell).join(', ')}: false`, chosen,
        svg('rect', { class: 'wrong', x: left + 1, y: top + 1, width: this.size - 2, height: this.size - 2 }))
    })
  }

  ray ({ ray }) {
    if (ray === null) return []
    const [x1, y1] = this.at(ray.from.x, ray.from.z)
    const [x2, y2] = this.at(ray.stop.x, ray.stop.z)
    const [x3, y3] = this.at(ray.to.x, ray.to.z)
    const parts = [svg('line', { class: `ray ${ray.seen ? 'free' : 'stopped'}`, x1, y1, x2, y2 })]
    if (!ray.seen) parts.push(svg('line', { class: 'ray beyond', x1: x2, y1: y2, x2: x3, y2: y3 }))
    if (ray.blocker) {
      const [left, top] = this.at(ray.blocker[0], ray.blocker[2])
      parts.push(svg('rect', { class: 'blocker', x: left, y: top, width: this.size, height: this.size }))
    }
    return parts
  }
}

/** Return true if a plan shows a thing of one storey: a wide one shows all that is at the storey or below. */
function isOn (run, { place }, storey) {
  return isWide(run) ? place[1] <= storey : place[1] === storey
}

function fill (paint, [i, k, scale], colour) {
  const [left, top] = [Math.round(i * scale), Math.round(k * scale)]
  paint.fillStyle = colour
  paint.fillRect(left, top, Math.round((i + 1) * scale) - left, Math.round((k + 1) * scale) - top)
}

function paintCell (paint, run, at, state, below, tones) {
  const here = state >= 0 ? run.states[state] : null
  if (state < 0) {
    fill(paint, at, tones.unknown)
    hatch(paint, at, tones.hatch)
  } else if (here.air || here.container) {
    const floor = below === undefined || below < 0 ? null : run.states[below]
    fill(paint, at, floor === null || floor.air ? tones.nowhere : mixed(floor.colour, tones.blend, 0.62))
  } else {
    const floor = below === undefined || below < 0 || run.states[below].air ? tones.nowhere : mixed(run.states[below].colour, tones.blend, 0.62)
    fill(paint, at, floor)
    shape(paint, at, here, tones)
  }
}

/** Draw a block's boxes from above; an open door is drawn as its thin side. */
function shape (paint, [i, k, scale], block, tones) {
  for (const [x0, , z0, x1, , z1] of block.boxes) {
    const [left, top] = [(i + x0 / 32) * scale, (k + z0 / 32) * scale]
    const [wide, high] = [(x1 - x0) / 32 * scale, (z1 - z0) / 32 * scale]
    paint.fillStyle = block.colour
    paint.fillRect(left, top, wide, high)
    paint.strokeStyle = tones.wall
    paint.lineWidth = Math.max(1, scale / 22)
    paint.strokeRect(left + 0.5, top + 0.5, wide - 1, high - 1)
  }
}

function hatch (paint, [i, k, scale], colour) {
  paint.save()
  paint.beginPath()
  paint.rect(i * scale, k * scale, scale, scale)
  paint.clip()
  paint.strokeStyle = colour
  paint.lineWidth = 1
  paint.beginPath()
  const step = Math.max(5, scale / 3)
  for (let at = -scale; at < scale; at += step) {
    paint.moveTo(i * scale + at, (k + 1) * scale)
    paint.lineTo(i * scale + at + scale, k * scale)
  }
  paint.stroke()
  paint.restore()
}

export function mixed (one, other, share) {
  const parts = [1, 3, 5].map(at => [parseInt(one.slice(at, at + 2), 16), parseInt(other.slice(at, at + 2), 16)])
  return `rgb(${parts.map(([a, b]) => Math.round(a + (b - a) * share)).join(',')})`
}

