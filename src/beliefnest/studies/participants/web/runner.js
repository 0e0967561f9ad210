'use strict'

/** Runner of a session without jsPsych: instructions, trials, progress, and the data at the end. */
;(async () => {
  const { csvOf, sessionOf, unpack } = globalThis.beliefnest
  const Plugin = globalThis.jsPsychBeliefnestQuestion
  const root = document.getElementById('page')
  // Longest wait for a server, in milliseconds.
  const LONGEST = 20000

  /**
   * Make an element with a text.
   * @param {string} tag Its tag.
   * @param {object} [properties] Properties of the element.
   * @param {...(Node|string)} children Children; texts become text nodes.
   * @returns {HTMLElement} The element.
   */
  function element (tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties)
    made.append(...children)
    return made
  }

  /**
   * Show elements in place of all others, and move the focus there.
   * @param {...Node} children The elements.
   */
  function show (...children) {
    const screen = element('section', { className: 'bn-screen', tabIndex: -1 }, ...children)
    stage.replaceChildren(screen)
    screen.focus()
    scrollTo(0, 0)
  }

  /**
   * Show a page of instructions until the participant continues.
   * @param {object[]} blocks Headings, paragraphs and lists.
   * @param {string} label Text of the button.
   * @returns {Promise<void>} Promise of the click.
   */
  function instruct (blocks, label) {
    const button = element('button', { type: 'button', className: 'bn-button bn-continue' }, label)
    show(...blocks.map(block), button)
    return new Promise(resolve => button.addEventListener('click', () => resolve()))
  }

  /**
   * Make a block of instructions.
   * @param {object} block Its `kind` and its `text`, or the `items` of a list.
   * @returns {HTMLElement} The element.
   */
  function block ({ kind, text, items }) {
    if (kind === 'list') return element('ul', {}, ...items.map(each => element('li', {}, each)))
    return element(kind === 'heading' ? 'h1' : 'p', {}, text)
  }

  /**
   * Show a trial with the plugin.
   * @param {object} trial Parameters of the plugin, and `data`.
   * @returns {Promise<object>} Data of the plugin.
   */
  function run (trial) {
    return new Promise(resolve => new Plugin({ finishTrial: resolve }).trial(stage, { button_label: 'Continue', ...trial }))
  }

  /**
   * Let the browser ask before it leaves the page and loses the answers.
   * @param {Event} event The event `beforeunload`.
   */
  function warn (event) {
    event.preventDefault()
  }

  /**
   * Make a button that saves a text as a file.
   * @param {string} label Its text.
   * @param {string} name Name of the file.
   * @param {string} type Media type.
   * @param {string} content Content of the file.
   * @returns {HTMLElement} The button.
   */
  function saving (label, name, type, content) {
    const button = element('button', { type: 'button', className: 'bn-button' }, label)
    button.addEventListener('click', () => {
      const link = element('a', { href: URL.createObjectURL(new Blob([content], { type })), download: name })
      link.click()
      removeEventListener('beforeunload', warn)
      setTimeout(() => URL.revokeObjectURL(link.href), 1000)
    })
    return button
  }

  /**
   * Send what has not been sent to the address of the study.
   * @returns {Promise<boolean>} True if nothing is left to send.
   */
  async function send () {
    const batch = [...state.unsent]
    if (!batch.length) return true
    try {
      const headers = { 'Content-Type': 'application/json' }
      const signal = AbortSignal.timeout(LONGEST)
      const answer = await fetch(study.post, { method: 'POST', headers, signal, body: JSON.stringify(batch) })
      if (!answer.ok) return false
    } catch {
      // The rows stay unsent: the next answer and the end send them again.
      return false
    }
    state.unsent.splice(0, batch.length)
    keep()
    return true
  }

  /**
   * Send a row with all unsent ones, after what is being sent.
   * @param {object} row The row.
   */
  function post (row) {
    if (!study.post) return
    state.unsent.push(row)
    keep()
    sending = sending.then(send)
  }

  /** Keep the session in the browser. */
  function keep () {
    remember(localStorage, place, JSON.stringify(state))
  }

  /** Send the answers if the study says where, and show the end. */
  async function conclude () {
    if (!study.post) return end('Please save your answers as a file.')
    show(element('p', { role: 'status' }, 'Your answers are being sent.'))
    await sending
    if (!await send()) return ask()
    removeEventListener('beforeunload', warn)
    end('Your answers have been sent.')
  }

  /**
   * Show the end, with the data.
   * @param {string} sentence Sentence about the data.
   */
  function end (sentence) {
    const controls = element('div', { className: 'bn-controls' }, ...savers())
    show(element('h1', {}, 'Thank you.'), ...study.ending.map(block), element('p', { role: 'status' }, sentence), controls)
    root.dataset.ended = 'yes'
  }

  /** Ask the participant to send again or to save the answers. The study's own ending follows only then. */
  function ask () {
    const sentence = 'Your answers could not be sent. Please save them as a file and give it to the people who asked you, or try again.'
    const again = element('button', { type: 'button', className: 'bn-button' }, 'Try again')
    again.addEventListener('click', () => conclude())
    const ending = element('div', { hidden: true }, element('h1', {}, 'Thank you.'), ...study.ending.map(block))
    const files = savers()
    for (const file of files) file.addEventListener('click', () => { ending.hidden = false })
    show(element('p', { role: 'status' }, sentence), element('div', { className: 'bn-controls' }, again, ...files), ending)
    root.dataset.ended = 'yes'
  }

  /**
   * Make the buttons that save the answers.
   * @returns {HTMLElement[]} The buttons.
   */
  function savers () {
    const { rows } = state
    const name = `answers-${rows[0].participant.replace(/[^\w-]/g, '_')}`
    return [
      saving('Save answers (CSV)', `${name}.csv`, 'text/csv', csvOf(rows)),
      saving('Save answers (JSON)', `${name}.json`, 'application/json', JSON.stringify(rows, null, 1))
    ]
  }

  /**
   * Return a text that the browser keeps; null if there is none, or the browser keeps nothing.
   * @param {Storage} storage Where it is kept.
   * @param {string} key Its name.
   * @returns {string|null} The text.
   */
  function recall (storage, key) {
    try {
      return storage.getItem(key)
    } catch {
      return null
    }
  }

  /**
   * Let the browser keep a text, if it keeps anything.
   * @param {Storage} storage Where it is kept.
   * @param {string} key Its name.
   * @param {string} text The text.
   */
  function remember (storage, key, text) {
    try {
      storage.setItem(key, text)
    } catch {
      // Without storage a reload begins anew, as the question before leaving says.
    }
  }

  /**
   * Return the participant's session. A drawn id stays the same in this tab.
   * @returns {object} The session.
   */
  function sessionHere () {
    const session = sessionOf(study)
    const { participant } = session.properties
    if (!participant.startsWith('drawn-')) return session
    const key = `beliefnest ${location.pathname} ${study.study} drawn`
    const before = recall(sessionStorage, key)
    if (before === null) {
      remember(sessionStorage, key, participant)
      return session
    }
    const query = new URLSearchParams(location.search)
    query.set('participant', before)
    return sessionOf(study, `?${query}`)
  }

  /**
   * Show the instructions, or how far the participant came before.
   * @returns {Promise<void>} Promise of the last click.
   */
  async function begin () {
    if (state.rows.length) {
      const text = `You have answered ${state.rows.length} of ${trials.length} questions. Your answers are kept.`
      return instruct([{ kind: 'paragraph', text }], 'Continue')
    }
    for (const [at, page] of study.pages.entries()) await instruct(page, at < study.pages.length - 1 ? 'Continue' : 'Begin')
  }

  const progress = element('progress', { className: 'bn-progress', value: 0, ariaLabel: 'Progress' })
  const stage = element('main', { className: 'bn-stage' })
  root.append(element('header', {}, progress), stage)
  const study = await unpack(JSON.parse(document.getElementById('data').textContent))
  document.title = study.title
  let session
  try {
    session = sessionHere()
  } catch (error) {
    show(element('p', { role: 'alert' }, error.message))
    document.documentElement.dataset.ready = 'yes'
    return
  }
  const { trials } = session
  const place = `beliefnest ${location.pathname} ${study.study} ${session.properties.participant} ${session.properties.list}`
  const before = recall(localStorage, place)
  // What the browser keeps: the rows so far, those that no server has yet, and the time until the last one.
  const state = before === null ? { properties: session.properties, rows: [], unsent: [], elapsed: 0, begun: false } : JSON.parse(before)
  let sending = Promise.resolve()
  const { properties, rows } = state
  progress.max = trials.length
  progress.value = rows.length
  document.documentElement.dataset.ready = 'yes'
  if (rows.length < trials.length) {
    await begin()
    addEventListener('beforeunload', warn)
  }
  if (!state.begun) {
    state.begun = true
    post({ ...properties, trial_type: 'beliefnest-start' })
  }
  const begun = performance.now() - state.elapsed
  for (const [at, trial] of [...trials.entries()].slice(rows.length)) {
    const data = await run(trial)
    state.elapsed = Math.round(performance.now() - begun)
    const row = { ...properties, ...trial.data, ...data, trial_type: Plugin.info.name, trial_index: at, time_elapsed: state.elapsed }
    rows.push(row)
    keep()
    post(row)
    progress.value = at + 1
  }
  await conclude()
})()
