/** Things to show of one simulator at one tick: values of its track, with their marks. */

import { ago, itemsText } from './elements.js'
import { isWide, partsOf } from './run.js'

const MOST_SHOWN = 24
const FLAT = 3

/** Return agents, containers, dropped items, written signs and false blocks of a track at a tick. @returns {object} */
export function thingsOf (run, track, tick) {
  const wrong = new Set(track.wrong(tick))
  const cells = new Set([...track.cells(), ...(run.timelines[0]?.track('/')?.cells() ?? [])])
  return {
    agents: run.head.agents.map((look, number) => agentThing(run, track, tick, look, number, wrong)),
    containers: [...cells].sort((a, b) => a - b).map(cell => containerThing(run, track, tick, cell, wrong)),
    items: [...track.items(tick).values()],
    signs: writtenSigns(run, track, tick, wrong),
    wrong,
    wrongBlocks: [...wrong].filter(thing => partsOf(thing).kind === 'block').map(thing => partsOf(thing).number)
  }
}

/** Return the signs that are known to bear a text. */
function writtenSigns (run, track, tick, wrong) {
  if (!run.states.some(state => state.says !== undefined)) return []
  const signs = []
  track.grid(tick).forEach((state, cell) => {
    if (state < 0 || run.states[state].says === undefined) return
    const thing = `block-${cell}`
    const { name, says, claims = [] } = run.states[state]
    signs.push({ thing, cell, place: run.place(cell), name: `${name.replaceAll('_', ' ')} at ${run.place(cell).join(', ')}`, says, claims, marks: wrong.has(thing) ? ['false'] : [], age: null })
  })
  return signs
}

/** Return all that is known of a sign: its text, and what it claims. @returns {string} */
export function signText ({ says, claims }) {
  return `“${says}”${claims.length ? `, which claims that ${claims.join(' and that ')}` : ''}`
}

/** Return the part of a sign's text that is shown beside it. @returns {string} */
export function shortened (says) {
  return says.length > MOST_SHOWN ? `${says.slice(0, MOST_SHOWN - 1)}…` : says
}

function agentThing (run, track, tick, look, number, wrong) {
  const pose = track.agent(number, tick)
  const thing = `agent-${number}`
  const marks = []
  if (wrong.has(thing)) marks.push('false')
  if (pose === null) marks.push('unknown')
  else if (!pose.current) marks.push(memoryMark(pose))
  return { thing, number, teller: tellerOf(pose), belief: pose, look, pose, marks, age: pose === null ? null : tick - pose.seenAt, wrongItems: wrong.has(`inventory-${number}`) }
}

function containerThing (run, track, tick, cell, wrong) {
  const contents = track.contents(cell, tick)
  const thing = `container-${cell}`
  const marks = []
  if (wrong.has(thing)) marks.push('false')
  if (contents === null || (!contents.complete && Object.keys(contents.items).length === 0)) marks.push('unknown')
  else if (!contents.complete) marks.push('incomplete')
  if (contents !== null && !contents.current && !marks.includes('unknown')) marks.push(memoryMark(contents))
  const age = contents === null ? null : tick - contents.seenAt
  return { thing, cell, place: run.place(cell), name: run.thingName(thing), contents, belief: contents, marks, age, teller: tellerOf(contents) }
}

/**
 * Return the speaker of a claim, or `a sign`, that is the only ground for a belief; null if there are other grounds.
 * @returns {string|null}
 */
export function tellerOf (belief) {
  return belief !== null && !belief.current && belief.source === 'heard' ? belief.speaker ?? 'a sign' : null
}

function memoryMark (belief) {
  return tellerOf(belief) === null ? 'stale' : 'heard'
}

/**
 * Return the source and age of a memory in words. Nothing is called seen that was not perceived.
 * @param {object} belief The entry, with its `source`, and with its `speaker` if it is hearsay.
 * @param {number} age Its age in ticks.
 * @returns {string}
 */
export function memoryWords (belief, age) {
  const teller = tellerOf(belief)
  if (teller !== null) return `told by ${teller}${age > 0 ? ` ${ago(age)}` : ''}`
  if (belief.source === 'prior') return 'believed from the start'
  return `${belief.source === 'edited' ? 'edited' : 'seen'} ${ago(age)}`
}

/** Return the believed contents of a container in a few words. @returns {string} */
export function contentsText (contents) {
  if (contents === null) return 'not known to be there'
  const items = itemsText(contents.items)
  if (items) return contents.complete ? items : `${items}, perhaps more`
  return contents.complete ? 'empty' : 'not known'
}

/** Return the same, short enough for a label in a picture. @returns {string} */
export function contentsLabel (contents) {
  if (contents === null) return '?'
  return itemsText(contents.items) || (contents.complete ? 'empty' : '?')
}

/** Return marks, short enough for a place beside a label. The label itself shows what is unknown. @returns {string} */
export function signsText (run, marks, age) {
  return marks.filter(mark => mark !== 'unknown').map(mark => markSign(run, mark, age)).join(' ')
}

/** Return a mark in words, with its age. @returns {string} */
export function markWords (run, mark, age, belief = null) {
  if (mark === 'heard') return memoryWords(belief, age)
  if (mark === 'stale' && age !== null) {
    return belief?.source === 'prior' ? memoryWords(belief, age) : `remembered, ${memoryWords(belief, age)}`
  }
  return run.head.marks[mark].words
}

/** Return a mark, short enough for a place beside a thing. @returns {string} */
function markSign (run, mark, age) {
  const { sign } = run.head.marks[mark]
  return ['stale', 'heard'].includes(mark) && age !== null ? `${sign}${age}` : sign
}

/**
 * Return the storey with most containers, or else with most agents' feet, or else the lowest but one; in a wide world
 * with things at many heights, the highest.
 * @returns {number}
 */
export function mainStorey (run, track, tick) {
  const heights = thingsOf(run, track, tick).containers.map(each => each.place[1])
  if (heights.length === 0) {
    for (let number = 0; number < run.head.agents.length; number++) {
      const pose = track.agent(number, tick)
      if (pose) heights.push(Math.floor(pose.y + 0.01))
    }
  }
  if (heights.length === 0) return run.head.box.low[1] + 1
  // Outdoors, where things stand at many heights, hide nothing.
  if (isWide(run) && Math.max(...heights) - Math.min(...heights) > FLAT) return run.head.box.low[1] + run.shape[1] - 1
  const counts = new Map()
  for (const height of heights) counts.set(height, (counts.get(height) ?? 0) + 1)
  return [...counts].sort((a, b) => b[1] - a[1] || a[0] - b[0])[0][0]
}
