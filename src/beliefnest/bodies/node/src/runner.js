'use strict'
/** Runs the programs of agents in one region, together, tick by tick. */
const { stopBot } = require('./bots/bot')
const { View } = require('./percepts/view')
const { statesOf } = require('./regions/box')
const { Random } = require('./time/random')
const { ruleSpeech } = require('./bots/speech')
const { Memory } = require('./memory')

const MOST_AIMS = 100
// Ticks after the end of its program in which an agent may come down to the ground; who swims never does.
const LANDING_TICKS = 100
const USUAL = { speechTicks: 0, remembers: false, past: {} }

class Runner {
  /**
   * @param {import('./regions/regions').Regions} regions
   * @param {(request: {code: string, bot: object, scope: object, signal: AbortSignal, aim: function(object): void}) =>
   *   Promise<{ok: boolean, error: object | null, lines: number[], log: {text: string}[],
   *   unfinished: {what: string, line: number | null}[]}>} runProgram never rejects for a fault of the
   *   program; ends as soon as `signal` is aborted
   * @param {(bot: object, emit: (event: object) => void, signal: AbortSignal) => object} scopeOf what a
   *   program of this bot finds in scope; `emit` hears what its skills report until `signal` is aborted, and throws
   *   what they may not
   * @param {(tick: number) => Promise<object | null>} [perceive] asks what agents whose programs read percepts alone
   *   perceive now that a tick is over: PERCEPTS by agent; null: programs are to be ended
   */
  constructor (regions, runProgram, scopeOf, perceive) {
    this.regions = regions
    this.runProgram = runProgram
    this.scopeOf = scopeOf
    this.perceive = perceive
  }

  /**
   * @param {string} name of the region
   * @param {object} programs code by agent
   * @param {number} timeoutTicks after which programs that still run are ended
   * @param {object} [senses] PERCEPTS by agent, of those whose programs are to read nothing else
   * @param {{speechTicks: number, remembers: boolean, past: object}} [rules] ticks that it takes to say something; whether
   *   what programs call is remembered, and PAST by agent, of those that go on where they were cut
   * @returns {Promise<{tick: number, internal_state: Uint8Array, results: object}>} RESULT by agent
   */
  async run (name, programs, timeoutTicks, senses = {}, rules = USUAL) {
    const region = this.regions.get(name)
    const bodies = Object.keys(programs).map(agent => region.body(agent))
    const first = region.tick
    const runs = []
    const ended = await this.regions.resumed(region, async () => {
      Object.entries(programs).forEach(([agent, code], index) => {
        const view = senses[agent] === undefined ? null : this.viewOf(region, bodies[index], senses[agent])
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
    const states = statesOf(percepts.states, region.box)
    return new View({ bot, clock: this.regions.clock, box: region.box, names: region.known, percepts: { ...percepts, states } })
  }

  start (region, agent, { bot, view, rules }, code) {
    const abort = new AbortController()
    const run = { agent, view, abort, result: null, endTick: null, end: null, crash: null, isBrokenOff: false, rests: false }
    const aims = []
    const aim = made => { if (aims.length < MOST_AIMS) aims.push({ tick: region.tick, ...made }) }
    const emit = event => region.report(agent, event)
    const past = rules.past[agent] ?? null
    const memory = rules.remembers ? new Memory(past?.calls ?? [], () => region.tick, abort.signal) : null
    const request = { code, bot, scope: this.scopeOf(bot, emit, abort.signal, memory, this.regions.waitOf?.(region, bot, abort.signal)), signal: abort.signal, aim }
    // Numbers that others draw, too, would tell of what they do.
    if (view !== null) request.random = randomOf(region, agent, past?.tick ?? region.tick)
    const isRuled = rules.speechTicks > 0 || memory !== null
    const speech = isRuled ? ruleSpeech(bot, { ticks: rules.speechTicks, memory, signal: abort.signal }) : null
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

  // What programs leave undone is broken off before the last frame is made, which so tells of it.
  async untilEnded (region, runs, timeoutTicks) {
    let lastTick = region.tick + timeoutTicks
    let over = false
    const look = async () => {
      region.faults = region.faults.filter(fault => !this.blame(region, runs, fault))
      for (const run of runs) await this.bringToRest(region, run)
      over = runs.some(({ crash }) => crash !== null) || runs.every(({ rests }) => rests) || region.tick >= lastTick
      if (!over) return
      await this.endAll(region, runs, timeoutTicks)
      for (const run of runs) await this.breakOff(region, run)
      await this.regions.bodies.finish(region, runs.map(({ agent }) => agent))
    }
    while (!over) {
      const changed = await this.regions.tick(region, look)
      if (!over && !await this.look(region, runs, changed)) lastTick = region.tick
    }
  }

  /**
   * Bring the body of an agent whose program has ended to rest: what it does from then on must not depend on how long
   * others' programs go on.
   */
  async bringToRest (region, run) {
    if (run.result === null || run.rests) return
    await this.breakOff(region, run)
    run.rests = await this.regions.bodies.stand(region, run.agent, region.tick < run.endTick + LANDING_TICKS)
  }

  /** End, once, what a program that has ended left under way. */
  async breakOff (region, run) {
    if (run.isBrokenOff) return
    run.isBrokenOff = true
    run.endTick ??= region.tick
    await this.regions.bodies.rest(region, run.agent, run.result.unfinished.length === 0)
  }

  /**
   * Let programs that read percepts alone have what came of the tick that is over.
   * @param {boolean} changed whether anything did; if not, there is nothing new to perceive
   * @returns {Promise<boolean>} true if programs go on
   */
  async look (region, runs, changed) {
    const limited = runs.filter(({ view, result, crash }) => view !== null && (result ?? crash) === null)
    if (limited.length === 0) return true
    const told = changed ? await this.perceive(region.tick) : {}
    if (told === null) return false
    for (const { agent, view } of limited) region.runAs(agent, () => view.update(told[agent] ?? null))
    return true
  }

  /**
   * Let the program of the agent in whose bot something was thrown fail with it, or the only one there is.
   * @returns {boolean} true if there is such a program
   */
  blame (region, runs, { error, agent, lost }) {
    const own = runs.find(each => each.agent === agent)
    // Others go on without a bot that lost its connection.
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
 * @param {object} report of the sandbox
 * @param {string[]} stopped what the bot was still doing
 * @param {{kind: string, message: string} | null} end why the program was ended, if it did not end by itself
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
