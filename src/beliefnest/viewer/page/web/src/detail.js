/** Texts beside the pictures: the content of a simulator, and the reasons for the clicked belief. */

import { badge, button, element, itemsText, pointText, refill } from './elements.js'
import { lookWords } from './ray.js'
import { partsOf } from './run.js'
import { contentsText, markWords, memoryWords, signText, tellerOf } from './things.js'

export class Detail {
  constructor (choose, source) {
    this.choose = choose
    this.source = source
    this.title = element('h2')
    this.about = element('p', { class: 'about' })
    this.holds = element('div', { class: 'holds' })
    this.chosen = element('section', { class: 'chosen-thing', 'aria-live': 'polite' })
    this.element = element('aside', { class: 'detail', 'aria-label': 'what it holds' }, this.title, this.about, this.holds, this.chosen)
    this.shown = null
    this.asked = null
  }

  draw (scene) {
    const { run, track, tick, choice, things } = scene
    this.title.textContent = believesText(track)
    const own = track.path === track.timeline.facts.path
    const mode = own ? `control mode, branch “${track.timeline.facts.branch}”` : `follow mode, on ${track.timeline.name}`
    this.about.textContent = `${track.path} · ${mode} · tick ${tick}`
    const focusedRow = document.activeElement?.dataset?.row
    refill(this.holds,
      table('Containers', things.containers.map(each => this.row(run, each, contentsText(each.contents), choice))),
      table('Signs', things.signs.map(each => this.row(run, each, signText(each), choice))),
      table('Agents', things.agents.map(each => this.row(run, each, placeText(each.pose), choice))),
      this.others(run, things))
    if (focusedRow !== undefined) this.holds.querySelector(`[data-row="${CSS.escape(focusedRow)}"]`)?.focus()
    this.drawChosen(scene)
  }

  row (run, each, value, choice) {
    const name = each.look?.name ?? each.name
    const marks = each.marks.map(mark => element('span', { class: `mark ${mark}`, 'data-mark': mark }, `${run.head.marks[mark].sign} ${markWords(run, mark, each.age, each.belief)}`))
    return element('button', {
      type: 'button',
      class: `thing${choice.thing === each.thing ? ' chosen' : ''}`,
      'data-row': each.thing,
      onclick: () => this.choose({ thing: each.thing, note: null })
    }, each.look ? badge(each.look, { small: true, ghost: !each.pose?.current }) : element('span', { class: 'crate', 'aria-hidden': 'true' }),
    element('span', { class: 'name' }, name), element('span', { class: 'value' }, value), element('span', { class: 'marks' }, ...marks))
  }

  others (run, things) {
    const faults = []
    if (things.wrongBlocks.length) faults.push(things.wrongBlocks.length === 1 ? '1 block is false' : `${things.wrongBlocks.length} blocks are false`)
    for (const each of things.agents) if (each.wrongItems) faults.push(`what ${each.look.name} has is false`)
    return faults.length ? element('p', { class: 'mark false' }, `${run.head.marks.false.sign} ${faults.join('; ')}.`) : null
  }

  drawChosen (scene) {
    const { run, track, tick, choice, noted } = scene
    const version = [run.number, track.timeline.number, track.path, tick, choice.thing, choice.note, choice.beside, choice.sees, JSON.stringify(scene.look)].join('|')
    if (version === this.shown) return
    this.shown = version
    if (noted) refill(this.chosen, ...noteParts(noted))
    else if (choice.thing) this.drawThing(scene)
    else refill(this.chosen, element('p', { class: 'hint' }, 'Click an agent, a container, a block or an event to see here why it is believed.'))
  }

  drawThing (scene) {
    const { run, track, tick, choice, beside } = scene
    const thing = choice.thing
    const why = element('div', { class: 'why' }, element('p', { class: 'hint' }, 'Looking up why …'))
    refill(this.chosen,
      element('h3', {}, run.thingName(thing)),
      element('dl', {},
        ...pair(track.path, valueText(run, track, tick, thing)),
        ...(beside && beside !== track ? pair(beside.path, valueText(run, beside, Math.min(tick, beside.timeline.facts.head), thing)) : [])),
      scene.viewer === null || thing === `agent-${scene.viewer}` ? null : element('p', { class: 'look' }, lookWords(run, scene.viewer, thing, scene.look)),
      element('h4', {}, 'Why'), why,
      button('Copy a link to this', 'copy a link to this view', event => copyLink(event.currentTarget), { class: 'link' }))
    clearTimeout(this.waiting)
    // While time runs, do not ask at every tick.
    this.waiting = setTimeout(() => this.explain(scene, thing, why), this.source.live ? 120 : 0)
  }

  async explain ({ run, track, tick }, thing, why) {
    const asked = this.asked = {}
    let reasons
    try {
      reasons = await this.source.explain(run, track, tick, thing.replace('inventory', 'agent'))
    } catch (error) {
      reasons = { error: `The server does not answer (${error.message}).` }
    }
    if (asked !== this.asked) return
    if (reasons === null) refill(why, ...groundParts(run, track, tick, thing))
    else if (reasons.error) refill(why, element('p', {}, reasons.error))
    else {
      const lines = reasons.lines.map(line => element('p', {}, line))
      if (reasons.t !== tick) lines.push(element('p', { class: 'hint' }, `This explanation is for tick ${reasons.t}.`))
      refill(why, ...lines)
    }
  }
}

/** Return the words that say whose belief a simulator is. @returns {string} */
export function believesText (track) {
  if (track.path === '/') return 'Reality'
  if (track.path === track.timeline.facts.path) return `${track.path}, acted out`
  return `What ${track.agents.join(' thinks ')} believes`
}

function placeText (pose) {
  return pose === null ? 'place not known' : pointText(pose)
}

function table (name, rows) {
  return rows.length ? element('section', {}, element('h3', {}, name), ...rows) : null
}

function pair (path, value) {
  return [element('dt', {}, path), element('dd', {}, value)]
}

function valueText (run, track, tick, thing) {
  const { kind, number } = partsOf(thing)
  if (kind === 'container') return contentsText(track.contents(number, tick))
  if (kind === 'block') {
    const state = track.grid(tick)[number]
    return state < 0 ? 'not known' : blockText(run.states[state])
  }
  const [items, complete] = track.owned(number, tick)
  const has = itemsText(items) ? `has ${itemsText(items)}${complete ? '' : ', perhaps more'}` : complete ? 'has nothing' : 'what it has is not known'
  if (kind === 'inventory') return has
  const pose = track.agent(number, tick)
  const age = pose && !pose.current ? `, ${memoryWords(pose, tick - pose.seenAt)}` : ''
  return `${placeText(pose)}${age}; ${has}`
}

function blockText ({ text, says }) {
  return says === undefined ? text : `${text} that says “${says}”`
}

/**
 * Return elements with the grounds that the page's own data has for a belief, for pages without the full chain of
 * perceptions.
 */
function groundParts (run, track, tick, thing) {
  const { kind, number } = partsOf(thing)
  const belief = kind === 'container' ? track.contents(number, tick) : kind === 'agent' ? track.agent(number, tick) : null
  const parts = []
  if (belief !== null) {
    const event = belief.event ? ` (${belief.event.replaceAll('_', ' ')})` : ''
    const teller = tellerOf(belief)
    const source = teller !== null ? `${teller} said so` : belief.source === 'prior' ? 'a prior belief' : `${belief.source}${event}`
    parts.push(element('p', {}, belief.current ? 'It is perceived at this tick.' : `It rests on tick ${belief.seenAt}: ${source}.`))
  }
  parts.push(element('p', { class: 'hint' }, 'Run “beliefnest serve RUN” to see the whole chain of perceptions.'))
  return parts
}

function noteParts ({ title, facts, texts }) {
  return [element('h3', {}, title), element('dl', {}, ...facts.flatMap(([name, value]) => pair(name, value))),
    ...texts.flatMap(([name, text]) => [element('h4', {}, name), element('pre', { tabindex: '0' }, text)])]
}

async function copyLink (pressed) {
  try {
    await navigator.clipboard.writeText(location.href)
    pressed.textContent = 'Copied'
  } catch {
    pressed.textContent = location.href
  }
}
