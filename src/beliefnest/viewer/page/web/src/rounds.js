/** Rounds of an episode: the acts of each agent per round, when the goal was reached, branches from a round. */

import { badge, element, refill } from './elements.js'

const SHORT = 64

export class Rounds {
  constructor (choose) {
    this.choose = choose
    this.about = element('p', { class: 'about' })
    this.goal = element('ul', { class: 'goal', 'aria-label': 'goal' })
    this.list = element('ol', { class: 'rounds' })
    this.element = element('section', { class: 'episode', 'aria-label': 'rounds', hidden: true }, element('h2', {}, 'Rounds'), this.about, this.goal, this.list)
    this.shown = null
    this.at = null
  }

  draw ({ run, timeline, tick, choice }) {
    const line = realLine(run, timeline)
    const branch = run.episode?.branches[line?.facts.branch]
    this.element.hidden = branch === undefined
    if (branch === undefined) return
    const now = branch.parts.findLastIndex(part => part.t <= tick)
    const last = branch.parts.at(-1)
    const version = JSON.stringify([run.number, line.number, now, choice.note, branch.parts.length, last?.agents, branch.goal, run.timelines.length])
    if (version === this.shown) return
    this.shown = version
    const focusedRound = document.activeElement?.dataset?.round
    this.drawAbout(run, branch, line)
    refill(this.goal, ...branch.goal.map(([text, never, when]) => this.condition(line, { text: never ? `not to be: ${text}` : text, never, when, open: isOpen(run, branch) })))
    const turns = branch.parts.some((part, number) => number > 0 && part.round === branch.parts[number - 1].round)
    refill(this.list, ...branch.parts.map((part, number) => this.part(run, line, part, { isNow: number === now, turns, choice })))
    if (focusedRound !== undefined) this.list.querySelector(`[data-round="${CSS.escape(focusedRound)}"]`)?.focus()
    else if (this.at !== null && this.at !== now) this.show(this.list.children[now])
    this.at = now
  }

  /** Scroll to a round, without moving the rest of the page. */
  show (round) {
    if (round) this.element.scrollTop = round.offsetTop - (this.element.clientHeight - round.offsetHeight) / 2
  }

  drawAbout (run, branch, line) {
    const { task, instance, rounds } = run.episode
    const ended = branch.reached !== null ? `goal reached at tick ${branch.reached}` : branch.violated !== null ? `goal lost at tick ${branch.violated}` : 'goal not reached'
    const played = new Set(branch.parts.map(part => part.round)).size
    const which = instance === null ? task : `${task}, instance ${instance}`
    const players = Object.entries(branch.policies).map(([agent, policy]) => `${agent} by ${policy}`).join(', ')
    refill(this.about, `${which}, branch “${line.facts.branch}”: ${played} of at most ${rounds} rounds, ${ended}. ${players}.`)
  }

  condition (line, { text, never, when, open }) {
    const words = when !== null ? `tick ${when}` : !open ? 'at no tick' : never ? 'at no tick so far' : 'not yet'
    return element('li', { class: when === null ? 'open' : 'true' },
      when === null
        ? element('span', {}, `○ ${text}: `, element('span', { class: 'when' }, words))
        : element('button', { type: 'button', onclick: () => this.seek(line, when) }, `● ${text}: `, element('span', { class: 'when' }, words)))
  }

  part (run, line, part, { isNow, turns, choice }) {
    const name = turns ? `${part.round + 1}, ${part.agents.map(each => each.agent).join()}` : String(part.round + 1)
    return element('li', { class: isNow ? 'round now' : 'round', 'aria-current': isNow ? 'step' : null },
      element('button', { type: 'button', class: 'begins', 'data-round': `${line.number} ${part.t}`, title: `ticks ${part.t} to ${part.end}`, onclick: () => this.seek(line, part.t) },
        element('strong', {}, `Round ${name}`), element('span', { class: 'when' }, `tick ${part.t}`)),
      ...part.agents.flatMap(each => [this.deed(run, line, part, each, choice), this.considered(each)]),
      ...forksAt(run, line, part).map(other => this.fork(run, line, other, part)),
      isNow ? element('p', { class: 'what-if' }, 'What if? ', element('code', {}, `episode.at(${part.round}).fork(${part.agents[0].agent}="…")`)) : null)
  }

  deed (run, line, part, each, choice) {
    const look = run.head.agents.find(({ name }) => name === each.agent)
    const number = run.programs.findIndex(program => program.path === '/' && program.branch === line.facts.branch && program.agent === each.agent && program.t >= part.t && program.t < part.end)
    const note = number < 0 ? null : `program-${number}`
    const words = element('span', { class: 'what' }, each.fault ? `none: ${each.fault}` : each.program ? `${each.goes_on ? '… ' : ''}${shortened(each.program)}` : 'nothing')
    const ended = ['', 'ok', 'none'].includes(each.ended) ? null : element('span', { class: `ended ${each.ended}` }, each.ended.replace('_', ' '))
    const why = each.reason && !each.fault && each.ended !== 'cut' ? element('span', { class: 'why' }, each.reason) : null
    const parts = [look ? badge(look, { small: true }) : null, words, ended, why]
    const title = [`${each.agent}: ${each.program || 'nothing'}`, each.reason].filter(Boolean).join('\n')
    if (note === null) return element('p', { class: 'deed', title }, ...parts)
    return element('button', {
      type: 'button', class: `deed${choice.note === note ? ' chosen' : ''}`, title, onclick: () => this.choose({ ...this.place(line, part.t), note })
    }, ...parts)
  }

  /** Return the courses that a policy considered, folded up; null: it recorded none. @returns {Element|null} */
  considered ({ agent, considered }) {
    if (!considered) return null
    const { courses, others, tried, reason } = considered
    return element('details', { class: 'considered' },
      element('summary', {}, `${agent} tried ${tried} ${tried === 1 ? 'course' : 'courses'}`),
      ...Object.entries(others).map(([name, program]) => element('p', {}, `expects that ${name} does: ${program ? shortened(program) : 'nothing'}`)),
      element('ol', {}, ...courses.map(([program, words]) => element('li', { title: program }, element('span', { class: 'when' }, `${words}: `), program ? shortened(program) : 'nothing'))),
      reason ? element('p', {}, `decided otherwise: ${reason}`) : null)
  }

  fork (run, line, other, part) {
    const mine = run.episode.branches[line.facts.branch].policies
    const theirs = run.episode.branches[other.facts.branch].policies
    const changed = Object.keys(theirs).filter(agent => theirs[agent] !== mine[agent]).map(agent => `${agent} by ${theirs[agent]}`)
    const words = `↳ ${other.facts.branch}${changed.length ? `: ${changed.join(', ')}` : ''}`
    return element('button', { type: 'button', class: 'fork', title: 'go to this branch', onclick: () => this.seek(other, part.t) }, words)
  }

  place (line, tick) {
    return { on: line.number, at: line.facts.path, tick: Math.max(line.facts.start, Math.min(line.facts.head, tick)) }
  }

  seek (line, tick) {
    this.choose({ ...this.place(line, tick), note: null })
  }
}

/** Return true if a branch of an episode can still continue. @returns {boolean} */
function isOpen (run, branch) {
  const played = new Set(branch.parts.map(part => part.round)).size
  return branch.reached === null && branch.violated === null && played < run.episode.rounds
}

/** Return the timeline of the real world that a timeline is, or belongs to. @returns {object|undefined} */
function realLine (run, timeline) {
  return timeline.facts.path === '/' ? timeline : run.timelines[0]
}

/** Return the branches of the real world that begin at the start of a round. @returns {object[]} */
function forksAt (run, line, part) {
  return run.timelines.filter(other => other.base === line && other.facts.path === '/' && other.facts.start === part.t && run.episode.branches[other.facts.branch])
}

function shortened (program) {
  const text = program.replaceAll(/\bawait /g, '').replaceAll(/\bbot, /g, '').replaceAll('new Vec3', '').replaceAll(/\s+/g, ' ').trim()
  return text.length > SHORT ? `${text.slice(0, SHORT)} …` : text
}
