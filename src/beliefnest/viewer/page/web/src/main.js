/** Entry point of the page: reads its data and draws the selection. */

import { Chooser } from './choice.js'
import { App } from './app.js'
import { element, refill } from './elements.js'
import { Run } from './run.js'
import { PackedSource, ServedSource, packedData } from './source.js'

const root = document.getElementById('page')

async function begin () {
  const { served, content } = await packedData(document.getElementById('data'))
  const runs = []
  const updates = content.updates ?? content.runs.map((update, number) => [number, update])
  for (const [number, update] of updates) take(runs, number, update)
  if (served) forgetToken()
  if (runs.length === 0) await waiting(runs, content)
  const chooser = new Chooser(firstView(runs, content.first))
  const source = served ? new ServedSource(() => app.later()) : new PackedSource()
  const app = new App(root, runs, chooser, source)
  app.draw()
  document.documentElement.dataset.ready = 'true'
  performance.mark('first-picture')
  if (served) follow(app, runs, source, content)
}

function take (runs, number, update) {
  if (runs[number] === undefined) {
    runs[number] = new Run()
    runs[number].number = number
  }
  runs[number].put(update)
}

/**
 * Return the first view, for an address without a selection: the simulator that the scenario asks about, beside
 * reality.
 */
function firstView (runs, first) {
  const [asked] = runs[0].head.asked
  return { ...(asked === undefined ? {} : { at: asked }), ...first }
}

/** Remove the token from the address, where others could read it; a cookie holds it now. */
function forgetToken () {
  if (location.search) history.replaceState(null, '', location.pathname + location.hash)
}

/** Wait for the beginning of a run. */
async function waiting (runs, content) {
  refill(root, element('p', { class: 'failed', role: 'status' }, 'The run has not begun yet …'))
  await new Promise(resolve => {
    const stream = new EventSource(`api/live?from=${content.count}`)
    stream.onmessage = ({ data, lastEventId }) => {
      const { run, update } = JSON.parse(data)
      content.count = Number(lastEventId)
      take(runs, run, update)
      stream.close()
      resolve()
    }
  })
}

/** Receive what the server sends about runs in progress; after a break, continue where the stream stopped. */
function follow (app, runs, source, content) {
  const stream = new EventSource(`api/live?from=${content.count}`)
  stream.onmessage = ({ data, lastEventId }) => {
    const { run, update } = JSON.parse(data)
    content.count = Number(lastEventId)
    take(runs, run, update)
    source.forget()
    app.grown(run)
  }
  stream.onerror = () => {
    app.tell('The server does not answer. The page shows the last data it received.')
    stream.close()
    setTimeout(() => follow(app, runs, source, content), 1000)
  }
  stream.onopen = () => app.tell('')
}

begin().catch(error => {
  refill(root, element('p', { class: 'failed', role: 'alert' }, `This page cannot be shown: ${error.message}`))
})
