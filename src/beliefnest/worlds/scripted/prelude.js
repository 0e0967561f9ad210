// Scope of programs of the scripted world. The file evaluates to a function of (Vec3, hints, time, skills, missing,
// username), where `missing` are skills without a twin here. That function returns the functions for Python: again,
// names, start, take, settle, see, hear. No code here calls Python: Python takes the program's requests after each turn.
(Vec3, hints, time, skills, missing, username) => {
  'use strict'
  const { parse, stringify } = JSON
  const waiting = new Map()
  let calls = []
  let log = []
  let done = null
  let room = 50_000
  let next = 1
  let seen = null
  let blocks = null
  let grid = null

  // Minecraft's data have booleans for these values, and texts for all others.
  const TRUTH = { true: true, false: false }

  // Failed calls whose errors the program may still handle.
  const failed = []

  /** Promise of a call's result, which records whether anything waits for it. */
  class Answer extends Promise {
    static get [Symbol.species] () { return Promise }

    then (...listeners) {
      this.isHeard = true
      return super.then(...listeners)
    }
  }

  const failure = (message, more) => Object.assign(new Error(message), more)
  const lacks = what => `the scripted world has no ${what}; open the nest with world="embedded" for that`
  const refuse = what => { throw failure(lacks(what), { kind: 'refused' }) }
  const elsewhere = { ...hints.ELSEWHERE, ...Object.fromEntries(missing.map(name => [name, lacks(name)])) }
  const offering = (object, what) => new Proxy(object, {
    get (target, key) {
      if (typeof key === 'symbol' || key === 'then' || key === 'toJSON' || key in target) return target[key]
      return refuse(`${what}.${key}`)
    }
  })

  function ask (name, args) {
    const waiter = { name, place: new Error('').stack }
    const answer = new Answer((resolve, reject) => Object.assign(waiter, { resolve, reject }))
    waiting.set(next, { ...waiter, answer })
    calls.push([next++, name, args])
    return answer
  }

  function skill (name) {
    return (...args) => {
      if (args[0] !== bot) throw failure(`${name}: the first argument must be bot, your own bot`, { skill: name })
      return ask(name, args.slice(1))
    }
  }

  const vector = ([x, y, z]) => new Vec3(x, y, z)
  const entity = (name, told) => ({
    type: 'player', username: name, name: 'player', position: vector(told.position), yaw: told.yaw, pitch: told.pitch, height: 1.8
  })
  const others = () => Object.entries(seen.agents).filter(([name]) => name !== username)

  /**
   * Number, in the palette, of the block in a cell of the box. The blocks are one list, x slowest; or chunks of equal
   * sides: of `runs`, the first list has the numbers of chunks after each run, and the second the run's chunk.
   */
  function stateIn ([i, j, k]) {
    const { shape, states, side, counts, margin, runs, chunks, first } = grid
    if (states !== undefined) return states[(i * shape[1] + j) * shape[2] + k]
    const cell = [i + margin[0], j + margin[1], k + margin[2]]
    const [a, b, c] = cell.map(value => Math.floor(value / side))
    const number = (a * counts[1] + b) * counts[2] + c
    let [low, high] = [0, runs[0].length - 1]
    while (low < high) {
      const middle = (low + high) >> 1
      if (runs[0][middle] > number) high = middle
      else low = middle + 1
    }
    const [x, y, z] = cell.map(value => value % side)
    return chunks[runs[1][low]].charCodeAt((x * side + y) * side + z) - first
  }

  function blockAt (position) {
    grid ??= parse(blocks)
    const cell = [position.x, position.y, position.z].map(Math.floor)
    const at = cell.map((value, axis) => value - grid.low[axis])
    if (at.some((value, axis) => value < 0 || value >= grid.shape[axis])) return null
    const text = grid.palette[stateIn(at)]
    if (text === null) return null
    const [name, written] = text.split(/[[\]]/)
    const properties = Object.fromEntries((written ?? '').split(',').filter(Boolean).map(each => {
      const [property, value] = each.split('=')
      return [property, TRUTH[value] ?? value]
    }))
    const front = seen.signs[cell.join()] ?? ''
    return { name, position: vector(cell), getProperties: () => properties, getSignText: () => [front, ''] }
  }

  async function openContainer (block) {
    if (block === null || typeof block !== 'object' || block.position === undefined) throw failure('openContainer: the argument must be a block')
    const items = Object.entries(await ask('openContainer', [block.position])).map(([name, count]) => ({ name, count }))
    return offering({ containerItems: () => items, close: () => undefined }, 'the window of a container')
  }

  // A program can listen only to speech.
  const EVENTS = ['chat', 'whisper', 'messagestr']
  const listeners = []

  function listen (event, listener, once) {
    if (!EVENTS.includes(event)) refuse(`event ${shown(event)}`)
    listeners.push({ event, listener, once })
    return bot
  }

  function unlisten (event, listener) {
    const index = listeners.findIndex(each => each.event === event && each.listener === listener)
    if (index >= 0) listeners.splice(index, 1)
    return bot
  }

  function tell (event, ...values) {
    for (const each of listeners.filter(each => each.event === event)) {
      if (each.once) unlisten(event, each.listener)
      try {
        each.listener.call(bot, ...values)
      } catch (error) {
        ended(error)
      }
    }
  }

  const bot = offering({
    get username () { return username },
    on: (event, listener) => listen(event, listener, false),
    addListener: (event, listener) => listen(event, listener, false),
    once: (event, listener) => listen(event, listener, true),
    off: unlisten,
    removeListener: unlisten,
    get entity () { return entity(username, seen.agents[username]) },
    get players () {
      const told = Object.entries(seen.players).map(([name, there]) => [name, { username: name, entity: there ? entity(name, seen.agents[name]) : null }])
      return Object.fromEntries(told)
    },
    get entities () { return Object.fromEntries(others().map(([name, told], number) => [number + 1, entity(name, told)])) },
    get inventory () { return offering({ items: () => Object.entries(seen.inventory).map(([name, count]) => ({ name, count })) }, 'bot.inventory') },
    get health () { return seen.health },
    get food () { return seen.food },
    blockAt,
    openContainer,
    openChest: openContainer,
    closeWindow: () => undefined,
    chat: text => { ask('bot.chat', [text]).catch(() => {}) },
    whisper: (name, text) => { ask('bot.whisper', [name, text]).catch(() => {}) },
    waitForTicks: ticks => ask('waitTicks', [ticks])
  }, 'bot')

  const shown = value => (typeof value === 'string' ? value : stringify(value) ?? String(value))
  function write (...values) {
    const text = values.map(shown).join(' ').slice(0, room)
    if (room > 0 && log.length < 1000) log.push(text)
    room -= text.length
  }
  const scope = {
    bot,
    Vec3,
    goals: offering({}, 'goals'),
    mcData: offering({}, 'mcData'),
    console: Object.fromEntries(['log', 'info', 'warn', 'error', 'debug'].map(level => [level, write])),
    located: (item, place) => ({ kind: 'located', item, place }),
    absent: (item, place) => ({ kind: 'absent', item, place }),
    positionOf: (agent, place) => ({ kind: 'position', agent, place }),
    blockAt: (place, state) => ({ kind: 'block', place, state }),
    ...Object.fromEntries(skills.map(name => [name, skill(name)])),
    waitForChat: (...args) => skill('waitForChat')(...args).then(heard => heard ?? null)
  }
  Vec3.prototype.toJSON = function () { return [this.x, this.y, this.z] }

  function ended (error) {
    const { message, name, stack, skill = null, reason = null, kind = null, place = '', slip = '' } = error instanceof Error ? error : { message: `the program threw ${shown(error)}` }
    const whole = `${name}: ${message}`
    const hint = hints.nearName(whole, Object.keys(scope), elsewhere) + hints.notAwaited(whole, Array.from(waiting.values(), each => each.name))
    done = { ok: false, message: `${message}${hint}${slip}`, name: String(name ?? 'Error'), stack: `${place}${stack ?? ''}`, skill, reason, kind }
  }

  return {
    // Reset the state for a new program, after one that has changed nothing in scope.
    again (name) {
      username = name
      waiting.clear()
      calls = []
      log = []
      done = null
      next = 1
    },
    names: () => stringify(Object.keys(scope)),
    start (main, isWhole) {
      const program = isWhole ? () => main(...Object.values(scope))(bot) : () => main(...Object.values(scope))
      Promise.resolve().then(program).then(() => { done ??= { ok: true } }, ended)
    },
    take () {
      for (const { answer, error } of failed.splice(0)) {
        if (!answer.isHeard && done?.ok !== false) ended(Object.assign(error, { slip: hints.NOT_AWAITED }))
      }
      const taken = stringify({ calls, log, done, waiting: waiting.size + listeners.length, listens: listeners.length > 0 })
      calls = []
      return taken
    },
    settle (id, ok, text) {
      const { resolve, reject, name, place, answer } = waiting.get(id)
      waiting.delete(id)
      const value = parse(text)
      if (ok) return resolve(value ?? undefined)
      const error = failure(`${name}: ${value.message}`, { skill: name, reason: value.reason, place })
      failed.push({ answer, error })
      reject(error)
    },
    hear (text) {
      for (const [speaker, words, to] of parse(text)) {
        if (to === null) tell('chat', speaker, words)
        else if (to === username) tell('whisper', speaker, words)
        const line = to === username ? `${speaker} whispers to you: ${words}` : `You whisper to ${to}: ${words}`
        tell('messagestr', to === null ? `<${speaker}> ${words}` : line)
      }
    },
    see (text, newBlocks) {
      seen = parse(text)
      time.ms = seen.ms
      if (newBlocks === null) return
      blocks = newBlocks
      grid = null
    }
  }
}
