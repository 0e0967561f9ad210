/** Sources of answers: the page's own data, or the server that sent the page. */

import { rowIndex } from './run.js'
import { numbersOf } from './runs.js'

/** Answers that were computed when the page was written. */
export class PackedSource {
  live = false

  async explain (run, track, tick, thing) {
    const rows = run.ahead.explanations[`${run.nameOf(track)} ${thing}`] ?? []
    const earlier = rows.filter(row => row.t <= tick).sort((a, b) => b.t - a.t)
    return earlier[0] ?? null
  }

  look (run, track, tick, viewer, thing) {
    const rows = run.ahead.looks[`${run.nameOf(track)} agent-${viewer} ${thing.replace('block', 'container')}`] ?? []
    return rows[rowIndex(rows, tick)]?.[1] ?? null
  }

  sight (run, track, tick, viewer) {
    const rows = run.ahead.sights[`${run.nameOf(track)} agent-${viewer}`] ?? []
    const number = rows[rowIndex(rows, tick)]?.[1]
    if (number === undefined) return null
    if (this.view?.run !== run || this.view.number !== number) this.view = { run, number, lengths: numbersOf(run.ahead.views[number]) }
    return this.view.lengths
  }

  async deepen () {
    return 'This file holds only the beliefs that were written into it. Write it again with' +
      '“beliefnest show RUN --html FILE --depth 3”, or run “beliefnest serve RUN”, which computes any belief on demand.'
  }
}

/** Answers of `beliefnest serve`. Lines of sight arrive later; the page then draws again. */
export class ServedSource {
  live = true

  constructor (again) {
    this.again = again
    this.answers = new Map()
  }

  /** Forget all answers, so that the page asks again; called when a run has grown. */
  forget () {
    this.answers.clear()
  }

  async explain (run, track, tick, thing) {
    return await this.ask('explain', { ...placeOf(run, track), tick, thing })
  }

  look (run, track, tick, viewer, thing) {
    return this.later('look', { ...placeOf(run, track), tick, viewer: run.head.agents[viewer].name, thing: thing.replace('container', 'block') })
  }

  sight (run, track, tick, viewer) {
    return this.later('sight', { ...placeOf(run, track), tick, viewer: run.head.agents[viewer].name })
  }

  async deepen (run, timeline, path) {
    const outcome = await this.ask('deepen', { run: run.number, on: timeline.number, path })
    return outcome.error ?? null
  }

  later (what, query) {
    const name = addressOf(what, query)
    if (!this.answers.has(name)) {
      this.answers.set(name, null)
      this.ask(what, query).then(outcome => {
        this.answers.set(name, outcome.answer ?? null)
        this.again()
      }, () => this.answers.delete(name))
    }
    return this.answers.get(name)
  }

  async ask (what, query) {
    const response = await fetch(addressOf(what, query), { credentials: 'same-origin' })
    return await response.json()
  }
}

function placeOf (run, track) {
  return { run: run.number, on: track.timeline.number, path: track.path }
}

function addressOf (what, query) {
  return `api/${what}?${new URLSearchParams(query)}`
}

/** Return the content of the page's data element. @returns {Promise<object>} */
export async function packedData (element) {
  const { served, packed } = JSON.parse(element.textContent)
  const bytes = Uint8Array.from(atob(packed), letter => letter.charCodeAt(0))
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))
  return { served, content: await new Response(stream).json() }
}
