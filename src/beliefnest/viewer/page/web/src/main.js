/** The page: reads its data, and draws what is chosen. */

import { Chooser } from './choice.js'
import { App } from './app.js'
import { element, refill } from './elements.js'
import { Run } from './run.js'
import { PackedSource, ServedSource } from './source.js'
import { packedData } from './unpack.js'

const root = document.getElementById('page')

async function begin () {
  const { served, content } = await packedData(document.getElementById('data'))
  const runs = content.runs.map((told, number) => {
    const run = new Run()
    run.number = number
    run.put(told)
    return run
  })
  const chooser = new Chooser(content.first)
  const source = served ? new ServedSource(() => app.later()) : new PackedSource()
  const app = new App(root, runs, chooser, source)
  app.draw()
  document.documentElement.dataset.ready = 'true'
  performance.mark('first-picture')
  if (served) follow(app, runs, source)
}

/** Takes what the server tells of runs that go on. */
function follow (app, runs, source) {
  const stream = new EventSource('api/live')
  stream.onmessage = ({ data }) => {
    const { run, update } = JSON.parse(data)
    runs[run].put(update)
    source.forget()
    app.grown(run)
  }
  stream.onerror = () => app.tell('The server does not answer; what is shown is what it told last.')
  stream.onopen = () => app.tell('')
}

begin().catch(error => {
  refill(root, element('p', { class: 'failed', role: 'alert' }, `This page cannot be shown: ${error.message}`))
})
