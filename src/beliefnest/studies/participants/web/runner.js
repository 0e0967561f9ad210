'use strict'

/** Runner of a session without jsPsych: instructions, trials, progress, and the data at the end. */
;(async () => {
  const { csvOf, sessionOf, unpack } = globalThis.beliefnest
  const Plugin = globalThis.jsPsychBeliefnestQuestion
  const root = document.getElementById('page')

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
   * Send the rows to the address of the study.
   * @param {object[]} rows The rows.
   * @returns {Promise<string>} Sentence for the participant.
   */
  async function sent (rows) {
    try {
      const headers = { 'Content-Type': 'application/json' }
      const answer = await fetch(study.post, { method: 'POST', headers, body: JSON.stringify(rows) })
      if (answer.ok) {
        removeEventListener('beforeunload', warn)
        return 'Your answers have been sent.'
      }
    } catch {
      // The sentence below tells the participant what to do.
    }
    return 'Your answers could not be sent. Please save them as a file and give it to the people who asked you.'
  }

  /**
   * Show the end, with the data.
   * @param {object[]} rows The rows.
   */
  async function conclude (rows) {
    const told = element('p', { role: 'status' }, study.post ? 'Your answers are being sent.' : 'Please save your answers as a file.')
    const name = `answers-${rows[0].participant.replace(/[^\w-]/g, '_')}`
    const csv = saving('Save answers (CSV)', `${name}.csv`, 'text/csv', csvOf(rows))
    const json = saving('Save answers (JSON)', `${name}.json`, 'application/json', JSON.stringify(rows, null, 1))
    show(element('h1', {}, 'Thank you.'), ...study.ending.map(block), told, element('div', { className: 'bn-controls' }, csv, json))
    if (study.post) told.textContent = await sent(rows)
    root.dataset.ended = 'yes'
  }

  const progress = element('progress', { className: 'bn-progress', value: 0, ariaLabel: 'Progress' })
  const stage = element('main', { className: 'bn-stage' })
  root.append(element('header', {}, progress), stage)
  const study = await unpack(JSON.parse(document.getElementById('data').textContent))
  document.title = study.title
  let session
  try {
    session = sessionOf(study)
  } catch (error) {
    show(element('p', { role: 'alert' }, error.message))
    document.documentElement.dataset.ready = 'yes'
    return
  }
  const { properties, trials } = session
  progress.max = trials.length
  document.documentElement.dataset.ready = 'yes'
  for (const [at, page] of study.pages.entries()) await instruct(page, at < study.pages.length - 1 ? 'Continue' : 'Begin')
  addEventListener('beforeunload', warn)
  const begun = performance.now()
  const rows = []
  for (const [at, trial] of trials.entries()) {
    const data = await run(trial)
    const places = { trial_type: Plugin.info.name, trial_index: at, time_elapsed: Math.round(performance.now() - begun) }
    rows.push({ ...properties, ...trial.data, ...data, ...places })
    progress.value = at + 1
  }
  await conclude(rows)
})()
