'use strict'
/** Runner of agents' programs: it runs the programs of one region together, tick by tick. */
const { stopBot } = require('./bots/bot')
const { View } = require('./percepts/view')
const { Terrain } = require('./regions/terrain')
const { Random } = require('./time/random')
const { ruleSpeech } = require('./bots/speech')
const { Memory } = require('./memory')

const MOST_AIMS = 100
// Number of ticks after the end of its program in which an agent may still land; a swimming agent never lands.
const LANDING_TICKS = 100
const USUAL = { speechTicks: 0, remembers: false, past: {}, mute: [] }

class Runner {
  /**
   * @param {import('./regions/regions').Regions} regions
   * @param {(request: {code: string, bot: object, scope: object, signal: AbortSignal, aim: function(object): void}) =>
   *   Promise<{ok: boolean, error: object | null, lines: number[], log: {text: string}[], unfinished: {what: string,
   *   line: number | null}[]}>} runProgram runs a program; it never rejects for a fault of the program, and ends as
   *   soon as `signal` is aborted
   * @param {(bot: object, emit: (event: object) => void, signal: AbortSignal) => object} scopeOf returns the scope of
   *   a bot's program; its skills pass their events to `emit`, which throws if an event is not allowed
   * @param {(tick: number) => Promise<object | null>} [perceive] asks Python for the percepts of a tick: PERCEPTS by
   *   agent, for the agents whose programs read only percepts; null ends the programs
   */
  constructor (regions, runProgram, scopeOf, perceive) {
    this.regions = regions
    this.runProgram = runProgram
    this.scopeOf = scopeOf
    this.perceive = perceive
  }

  /**
   * Run programs until all have ended.
   * @param {string} name name of the region
   * @param {object} programs code by agent
   * @param {number} timeoutTicks number of ticks, followed by this process, after which running programs are ended
   * @param {object} [senses] PERCEPTS by agent, for the agents whose programs read only percepts
   * @param {{speechTicks: number, remembers: boolean, past: object, mute: string[]}} [rules] ticks per utterance; whether
   *   calls of programs are remembered; PAST by agent, for programs that are resumed; and the agents that cannot speak
   * @returns {Promise<{tick: number, internal_state: Uint8Array, results: object}>} RESULT by agent
   */
  async run (name, programs, timeoutTicks, senses = {}, rules = USUAL) {
    const region = this.regions.get(name)
    const bodies = Object.keys(programs).map(agent => region.body(agent))
    const first = region.tick
    const runs = []
    const ended = await this.regions.resumed(region, async () => {
      Object.entries(programs).forEach(([agent, code], index) => {
        const view = Object.hasOwn(senses, agent) ? this.viewOf(region, bodies[index], senses[agent]) : null
        runs.push(this.start(region, agent, { bot: view?.bot ?? bodies[index].bot, view, rules }, code))
      })
      try {
        await this.untilEnded(region, runs, timeoutTicks)
      } finally {
        await this.endAll(region, runs, timeoutTicks)
      }
    })
    const results = Object.keys(programs).map((agent, index) => [agent, { ...runs[index].result, ticks: runs[index].endTick - first }])
    return { ...ended, results: Object.fromEntries(results) }
  }

  viewOf (region, { bot }, percepts) {
    const states = Terrain.read(percepts.states, region.box)
    return new View({ bot, clock: this.regions.clock, box: region.box, names: region.agentNames, percepts: { ...percepts, states } })
  }

  start (region, agent, { bot, view, rules }, code) {
    const abort = new AbortController()
    const run = { agent, view, abort, result: null, endTick: null, end: null, crash: null, isBrokenOff: false, rests: false }
    const aims = []
    const aim = made => { if (aims.length < MOST_AIMS) aims.push({ tick: region.tick, ...made }) }
    const emit = event => region.report(agent, event)
    const past = Object.hasOwn(rules.past, agent) ? rules.past[agent] : null
    const memory = rules.remembers ? new Memory(past?.calls ?? [], () => region.tick, abort.signal) : null
    const request = { code, bot, scope: this.scopeOf(bot, emit, abort.signal, memory, this.regions.waitOf?.(region, bot, abort.signal)), signal: abort.signal, aim }
    // Random numbers that agents share would reveal the acts of others.
    if (view !== null) request.random = randomOf(region, agent, past?.tick ?? region.tick)
    const isMute = rules.mute.includes(agent)
    const isRuled = rules.speechTicks > 0 || memory !== null || isMute
    const speech = isRuled ? ruleSpeech(bot, { ticks: rules.speechTicks, memory, isMute, signal: abort.signal }) : null
    this.runProgram(request).then(async report => {
      if (speech !== null) await speech.over()
      abort.abort()
      speech?.undo()
      const stopped = stopBot(bot)
      if (view !== null) stopBot(view.close())
      run.result = { ...resultOf(report, stopped, run.end), aims, ...(memory && { calls: memory.calls }) }
    }).catch(error => { run.crash = error })
    return run
  }

  // Run ticks until the end. The last tick ends unfinished acts before its frame is made, so that the frame contains
  // their effects.
  async untilEnded (region, runs, timeoutTicks) {
    // Ticks that pass elsewhere while this process does not run count as one: no program can use them.
    let left = timeoutTicks
    let over = false
    const look = async () => {
      region.faults = region.faults.filter(fault => !this.blame(region, runs, fault))
      for (const run of runs) await this.bringToRest(region, run)
      over = runs.some(({ crash }) => crash !== null) || runs.every(({ rests }) => rests) || left <= 0
      if (!over) return
      await this.endAll(region, runs, timeoutTicks)
      for (const run of runs) await this.breakOff(region, run)
      await this.regions.bodies.finish(region, runs.map(({ agent }) => agent))
    }
    while (!over) {
      left -= 1
      const changed = await this.regions.tick(region, look)
      if (!over && !await this.look(region, runs, changed)) left = 0
    }
  }

  /**
   * Bring an agent whose program has ended to rest, so that its further motion does not depend on how long others'
   * programs run.
   */
  async bringToRest (region, run) {
    if (run.result === null || run.rests) return
    await this.breakOff(region, run)
    run.rests = await this.regions.bodies.stand(region, run.agent, region.tick < run.endTick + LANDING_TICKS)
  }

  /** End the unfinished acts of a program that has ended; a second call has no effect. */
  async breakOff (region, run) {
    if (run.isBrokenOff) return
    run.isBrokenOff = true
    run.endTick ??= region.tick
    await this.regions.bodies.rest(region, run.agent, run.result.unfinished.length === 0)
  }

  /**
   * Give programs that read only percepts the percepts of the tick that has ended.
   * @param {boolean} changed whether anything changed; if not, there is nothing new to perceive
   * @returns {Promise<boolean>} true if the programs continue
   */
  async look (region, runs, changed) {
    const limited = runs.filter(({ view, result, crash }) => view !== null && (result ?? crash) === null)
    if (limited.length === 0) return true
    const percepts = changed ? await this.perceive(region.tick) : {}
    if (percepts === null) return false
    for (const { agent, view } of limited) region.runAs(agent, () => view.update(Object.hasOwn(percepts, agent) ? percepts[agent] : null))
    return true
  }

  /**
   * Fail the program of the agent whose bot threw an error, or the only program there is.
   * @returns {boolean} true if there is such a program
   */
  blame (region, runs, { error, agent, lost }) {
    const own = runs.find(each => each.agent === agent)
    // Other programs continue without a bot that lost its connection.
    if (lost !== undefined && own === undefined) return true
    const run = runs.length === 1 ? runs[0] : own
    if (run === undefined) return false
    if (run.result !== null || run.end !== null) return true
    const what = lost === undefined ? `failed in the game's own code: ${error?.message ?? error}` : `lost its connection to the server (${lost})`
    run.end = { kind: 'bot', message: `the bot of ${run.agent} ${what}` }
    run.endTick = region.tick
    run.abort.abort()
    return true
  }

  async endAll (region, runs, timeoutTicks) {
    for (const run of runs) {
      if (run.result !== null || run.end !== null) continue
      run.end = { kind: 'timeout', message: `the program did not end within ${timeoutTicks} ticks` }
      run.endTick = region.tick
      run.abort.abort()
    }
    await this.regions.clock.advance(0)
    const crashed = runs.find(({ crash }) => crash !== null)
    if (crashed !== undefined) throw crashed.crash
  }
}

/**
 * Return the result of a program.
 * @param {object} report report of the sandbox
 * @param {string[]} stopped activities of the bot that were stopped
 * @param {{kind: string, message: string} | null} end reason why the program was ended; null if it ended by itself
 * @returns {object} RESULT, without ticks
 */
function resultOf ({ ok, error, lines, log, unfinished }, stopped, end) {
  return {
    ok: ok && end === null,
    error: end === null ? error : { ...error, ...end },
    lines,
    log: log.map(({ text }) => text),
    unfinished: [...unfinished, ...stopped.map(what => ({ what, line: null }))]
  }
}

function randomOf (region, agent, tick) {
  const random = new Random(`${region.seed} ${tick} ${agent}`)
  return () => random.next()
}

module.exports = { Runner }
