'use strict'

/** Sessions of participants: their list, the order of all they see, and their data. Used with jsPsych and without. */
;(() => {
  const ID_NAMES = ['participant', 'PROLIFIC_PID', 'workerId', 'id']

  /**
   * Decode the study that the folder contains.
   * @param {string} packed JSON, compressed with deflate, in base64.
   * @returns {Promise<object>} The study.
   */
  async function unpack (packed) {
    const bytes = Uint8Array.from(atob(packed), letter => letter.charCodeAt(0))
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))
    return JSON.parse(await new Response(stream).text())
  }

  /**
   * Return the FNV-1a hash of a text.
   * @param {string} text The text.
   * @returns {number} A whole number of 32 bits.
   */
  function hash (text) {
    let value = 0x811c9dc5
    for (const byte of new TextEncoder().encode(text)) value = Math.imul(value ^ byte, 0x01000193) >>> 0
    return value
  }

  /**
   * Return a generator of random numbers (mulberry32).
   * @param {string} seed Its seed.
   * @returns {Function} Function that returns the next number, from 0 to below 1.
   */
  function randomOf (seed) {
    let state = hash(seed)
    return () => {
      state = (state + 0x6d2b79f5) | 0
      let mixed = Math.imul(state ^ (state >>> 15), 1 | state)
      mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed
      return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296
    }
  }

  /**
   * Return a list in random order (Fisher and Yates).
   * @param {Array} values The values.
   * @param {Function} random Generator of random numbers.
   * @returns {Array} A new list.
   */
  function shuffled (values, random) {
    const order = [...values]
    for (let last = order.length - 1; last > 0; last--) {
      const other = Math.floor(random() * (last + 1))
      ;[order[last], order[other]] = [order[other], order[last]]
    }
    return order
  }

  /**
   * Return the participant's id: from the address, or drawn.
   * @param {URLSearchParams} query Parameters of the address.
   * @returns {string} The id.
   */
  function participantOf (query) {
    const id = ID_NAMES.map(name => query.get(name)?.trim()).find(Boolean)
    if (id) return id
    const drawn = crypto.getRandomValues(new Uint8Array(8))
    return `drawn-${[...drawn].map(byte => byte.toString(16).padStart(2, '0')).join('')}`
  }

  /**
   * Return the parameters of the address that are neither the id nor the list.
   * @param {URLSearchParams} query Parameters of the address.
   * @returns {object} `address` with their values by name; nothing if there are none.
   */
  function addressOf (query) {
    const used = ID_NAMES.find(name => query.get(name)?.trim())
    const others = [...query].filter(([name]) => name !== used && name !== 'list')
    return others.length ? { address: Object.fromEntries(others) } : {}
  }

  /**
   * Return the number of a participant's list: as the address says, else by the number that is the id, else by the hash of the id.
   * @param {object} study The study.
   * @param {string} participant The participant's id.
   * @param {URLSearchParams} query Parameters of the address.
   * @returns {number} Number of the list, from 1.
   * @throws {Error} There is no such list.
   */
  function listOf (study, participant, query) {
    const count = study.lists.length
    const asked = query.get('list')
    if (asked !== null) {
      const list = Number(asked)
      if (Number.isInteger(list) && list >= 1 && list <= count) return list
      throw new Error(`There is no list ${asked}: the address may name list 1 to ${count}.`)
    }
    const number = /^\d{1,15}$/.test(participant) ? Number(participant) + count - 1 : hash(participant)
    return number % count + 1
  }

  /**
   * Return the trials of one view of an item.
   * @param {object} item The item.
   * @param {object} view The view: `owner`, `story`, `film`, `questions`.
   * @param {Function} random Generator of random numbers.
   * @returns {object[]} Parameters of the plugin, and `data`.
   */
  function trialsOfView (item, view, random) {
    return shuffled(view.questions, random).map((asked, at) => ({
      owner: view.owner ?? '',
      story: view.story,
      film: view.film,
      seen: at > 0,
      question: asked.text,
      options: shuffled(asked.options, random),
      reason: asked.reason,
      data: { cell: item.cell, scenario: item.scenario, condition: item.condition, variation: item.variation, question: asked.id }
    }))
  }

  /**
   * Return a participant's session: all trials in their order, and what the data of each repeat.
   * @param {object} study The study.
   * @param {string} [search] The query of the address, such as `?participant=7&list=2`.
   * @returns {object} `properties` of all data, and `trials`.
   */
  function sessionOf (study, search = location.search) {
    const query = new URLSearchParams(search)
    const participant = participantOf(query)
    const list = listOf(study, participant, query)
    const random = randomOf(`${study.seed} ${participant}`)
    const items = shuffled(study.lists[list - 1], random).map(at => study.items[at])
    const trials = items.flatMap(item => shuffled(item.views, random).flatMap(view => trialsOfView(item, view, random)))
    const properties = { study: study.study, participant, list, shown: study.shown, started: new Date().toISOString(), ...addressOf(query) }
    return { properties, trials }
  }

  /**
   * Return the timeline of a session for jsPsych.
   * @param {object} session A session.
   * @returns {object[]} Its trials, each with the plugin as `type`.
   */
  function timelineOf (session) {
    return session.trials.map(trial => ({ type: globalThis.jsPsychBeliefnestQuestion, ...trial }))
  }

  /**
   * Return rows as CSV, with all texts quoted, as jsPsych writes it.
   * @param {object[]} rows The rows.
   * @returns {string} The text.
   */
  function csvOf (rows) {
    const columns = [...new Set(rows.flatMap(row => Object.keys(row)))]
    const lines = rows.map(row => columns.map(name => cellOf(row[name])).join(','))
    return [columns.map(cellOf).join(','), ...lines, ''].join('\r\n')
  }

  /**
   * Return one value of a CSV file.
   * @param {*} value The value; lists and objects become JSON.
   * @returns {string} The quoted text.
   */
  function cellOf (value) {
    const text = value == null ? '' : typeof value === 'object' ? JSON.stringify(value) : String(value)
    return `"${text.replaceAll('"', '""')}"`
  }

  globalThis.beliefnest = { csvOf, sessionOf, timelineOf, unpack }
})()
