/** Programs, prompts and model responses, as marks on the time line and as texts. */

import { count } from './elements.js'

/** Return the notes to list beside events: t, key, text, actor. @returns {object[]} */
export function notesOf (run, timeline) {
  const { path, branch } = timeline.facts
  const programs = run.programs.map((each, number) => ({ each, number }))
    .filter(({ each }) => each.path === path && each.branch === branch)
    .map(({ each, number }) => ({ t: each.t, note: `program-${number}`, actor: each.agent, text: `begins a program of ${count(each.ticks, 'tick')}${each.ok ? '' : `, which fails: ${each.error}`}` }))
  const prompts = run.prompts.map((each, number) => ({ each, number }))
    .filter(({ each }) => each.at === path && each.branch === branch)
    .map(({ each, number }) => ({ t: each.t, note: `prompt-${number}`, actor: null, text: `${each.model} is asked from ${each.path}${each.task ? `: ${each.task}` : ''}` }))
  return [...programs, ...prompts]
}

/** Return title, facts and texts of a note; null if there is none of that name. @returns {object|null} */
export function noteNamed (run, name) {
  const [kind, number] = (name ?? '').split('-')
  if (kind === 'program' && run.programs[number]) return programNote(run.programs[number])
  if (kind === 'prompt' && run.prompts[number]) return promptNote(run.prompts[number])
  if (kind === 'claim') return claimNote(run, number)
  return null
}

/** Return the name of the note of an event with claims. @returns {string} */
export function claimNoteOf (timeline, number) {
  return `claim-${timeline.number}.${number}`
}

/** Return the outcome of a claim in a simulator in a few words; empty if it is unknown. @returns {string} */
export function verdictWords (verdict) {
  if (verdict === null) return ''
  const condition = verdict.condition === null ? '' : ` (${verdict.condition})`
  return `${verdict.believed ? 'believed' : 'not believed'}${condition}`
}

function claimNote (run, name) {
  const [line, number] = name.split('.').map(Number)
  const timeline = run.timelines[line]
  const event = timeline?.events[number]
  if (event?.claims === undefined) return null
  const facts = event.claims.flatMap(([said, kind], index) => [
    ['claims', `${said}${kind ? `: ${kind}` : ''}`],
    ...[...timeline.tracks.values()].map(track => [track.path, verdictWords(track.verdict(number, index))]).filter(([, words]) => words)
  ])
  return { title: `${event.text}, tick ${event.t}`, facts, texts: [] }
}

function programNote (program) {
  const facts = [['ran in', `${program.path}, branch “${program.branch}”`], ['ticks', `${program.t} to ${program.t + program.ticks}`],
    ['ended', program.ok ? 'well' : program.error]]
  const texts = [['Program', program.code]]
  if (program.log.length) texts.push(['It wrote', program.log.join('\n')])
  return { title: `Program of ${program.agent}`, facts, texts }
}

function promptNote (prompt) {
  const facts = [['asked from', prompt.path], ['at', `tick ${prompt.t}`], ['model', prompt.model], ['attempt', prompt.attempt], ...(prompt.task ? [['task', prompt.task]] : [])]
  const texts = prompt.messages.map(([role, text]) => [`Prompt (${role})`, text])
  texts.push(['Answer', prompt.answer ?? `none: ${prompt.error}`])
  return { title: `What ${prompt.model} was asked`, facts, texts }
}
