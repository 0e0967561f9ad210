'use strict'
/**
 * Worlds with the skills of every bot and their emitted events. The same tests run in both kinds of worlds:
 * embedded.js, and over TCP if ../tcp/skills.test.js loads them.
 */
const { inWorld } = process.env.BELIEFNEST_SKILLS_OVER === 'tcp' ? require('../tcp/shared') : require('./embedded')
const { goals } = require('mineflayer-pathfinder')
const { Vec3 } = require('vec3')
const { bindSkills } = require('../../../../../skills/code')
const { stopBot } = require('../../src/bots/bot')
const { Runner } = require('../../src/runner')
const { createSandbox } = require('../../src/sandbox')
const { scopeOf } = require('../../src/scope')
const { agent, BOX } = require('../harness')

const FLOOR = BOX[0][1] + 1
// Compiled once for all worlds.
const sandbox = createSandbox()

/**
 * Run `body(world)` in a world with a stone floor; see embedded.js for a world's members.
 * @param {object} setting `agents` (AGENT by name), `blocks` ([x, y, z, name, properties]), `containers` ([x, y, z,
 *   ITEMS]), `box` (inclusive corners), `signal` of the skills
 */
async function withSkills ({ signal, ...setting }, body) {
  const defaults = { agents: { sally: agent([0.5, FLOOR, 0.5]) }, blocks: [], containers: [], box: BOX }
  await inWorld({ ...defaults, ...setting }, async world => {
    const emitted = []
    const skills = Object.fromEntries(Object.entries(world.bots).map(([name, bot]) => [name, bindSkills({
      bot, goals, Vec3, signal, emit: event => emitted.push({ actor: name, ...event })
    })]))
    await body({ ...world, skills, emitted, run: programsOf(world, emitted) })
  })
}

/**
 * Return a function that runs programs of several agents together in the sandbox, as a region does.
 * @returns {(programs: Object<string, string>, timeoutTicks?: number) => Promise<Object<string, object>>} resolves
 *   with RESULT by agent
 */
function programsOf ({ bots, nextTick }, emitted) {
  const region = { tick: 0, faults: [], body: name => ({ bot: bots[name] }), report: (actor, event) => emitted.push({ actor, ...event }) }
  const regions = {
    get: () => region,
    resumed: (_, action) => action(),
    async tick (_, before) {
      await nextTick()
      region.tick += 1
      await before()
    },
    bodies: { rest: async (_, name) => stopBot(bots[name]), stand: async () => true, async finish () {} },
    clock: { advance: nextTick }
  }
  const runner = new Runner(regions, request => sandbox.run(request), scopeOf)
  return async (programs, timeoutTicks = 2000) => {
    const { results } = await runner.run('', programs, timeoutTicks)
    if (region.faults.length > 0) throw region.faults[0].error
    return results
  }
}

/** Return the error with which a promise is rejected, once time has passed. */
async function failure (world, promise) {
  try {
    await world.during(promise)
  } catch (error) {
    return error
  }
  throw new Error('it did not fail')
}

module.exports = { agent, failure, withSkills, FLOOR, Vec3 }
