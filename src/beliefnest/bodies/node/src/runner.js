'use strict'
/** Runs the programs of agents in one region, together, tick by tick. */
const { stopBot } = require('./bots/bot')

class Runner {
  /**
   * @param {import('./regions/regions').Regions} regions
   * @param {(request: {code: string, bot: object, scope: object, signal: AbortSignal}) =>
   *   Promise<{ok: boolean, error: object | null}>} runProgram never rejects; ends soon after
   *   `signal` is aborted
   * @param {(bot: object, emit: (event: object) => void, signal: AbortSignal) => object} scopeOf what a
   *   program of this bot finds in scope; `emit` hears what its skills report until `signal` is aborted
   */
  constructor (regions, runProgram, scopeOf) {
    this.regions = regions
    this.runProgram = runProgram
    this.scopeOf = scopeOf
  }

  /**
   * @param {string} name of the region
   * @param {object} programs code by agent
   * @param {number} timeoutTicks after which programs that still run are ended
   * @returns {Promise<{tick: number, results: object}>} RESULT by agent
   */
  async run (name, programs, timeoutTicks) {
    const region = this.regions.get(name)
    const bodies = Object.keys(programs).map(agent => region.body(agent))
    const first = region.tick
    const runs = []
    await this.regions.resumed(region, async () => {
      Object.values(programs).forEach((code, index) => runs.push(this.start(region, bodies[index], code)))
      try {
        await this.untilEnded(region, runs, first + timeoutTicks)
      } finally {
        await this.endAll(region, runs, timeoutTicks)
      }
    })
    for (const run of runs) run.result.ticks = run.endTick - first
    const results = Object.keys(programs).map((agent, index) => [agent, runs[index].result])
    return { tick: region.tick, results: Object.fromEntries(results) }
  }

  start (region, { bot }, code) {
    const abort = new AbortController()
    const run = { bot, abort, result: null, endTick: null }
    const emit = event => region.emit({ ...event, actor: bot.username })
    const request = { code, bot, scope: this.scopeOf(bot, emit, abort.signal), signal: abort.signal }
    this.runProgram(request).then(({ ok, error }) => {
      if (run.result !== null) return
      run.result = { ok, error }
      abort.abort()
      stopBot(bot)
    }).catch(fault => region.faults.push(fault))
    return run
  }

  async untilEnded (region, runs, lastTick) {
    do {
      await this.regions.tick(region)
      for (const run of runs) if (run.result !== null) run.endTick ??= region.tick
    } while (runs.some(run => run.result === null) && region.tick < lastTick)
  }

  async endAll (region, runs, timeoutTicks) {
    for (const run of runs) {
      if (run.result !== null) continue
      run.result = { ok: false, error: timeoutError(timeoutTicks) }
      run.endTick = region.tick
      run.abort.abort()
      stopBot(run.bot)
    }
    await this.regions.clock.advance(0)
  }
}

function timeoutError (ticks) {
  return {
    kind: 'timeout',
    message: `the program did not end within ${ticks} ticks`,
    line: null,
    column: null,
    skill: null
  }
}

module.exports = { Runner }
