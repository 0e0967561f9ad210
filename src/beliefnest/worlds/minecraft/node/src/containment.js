'use strict'
/**
 * Benchmark of the sandbox: the same walk by a program and by the same skills called without a sandbox, in turns and
 * from the same snapshot. No channel is connected.
 */
const { Vec3 } = require('vec3')
const { runsOf } = require('./regions/box')
const { PROTOCOL, RequestHandler } = require('./requestHandler')
const { realNow } = require('./time/install')
const versions = require('./versions')

const REGION = 'hall'
const AGENT = 'walker'
const FLOOR = -52
const BOX = [[-21, FLOOR, -21], [21, FLOOR + 3, 21]]
const CORNERS = [[15, 15], [-15, 10], [-10, -17], [17, -12]].map(([x, z]) => [x, FLOOR + 1, z])
const TIMEOUT_TICKS = 2000
const PROGRAM = CORNERS.map(corner => `await goToPosition(bot, new Vec3(${corner.join(', ')}), 1)`).join('\n')

/**
 * Measure walks with and without the sandbox.
 * @param {import('./time/clock').Clock} clock clock that is installed
 * @param {number} pairs number of runs of each kind
 * @returns {Promise<{contained: number, direct: number}[]>} durations of the walks in milliseconds, pair by pair
 */
async function measureContainment (clock, pairs) {
  const handler = new RequestHandler(clock, () => {})
  await handler.hello({ protocol: PROTOCOL, seed: 0, minecraft: versions.minecraft })
  const { runner } = handler
  const start = await handler.perform({ op: 'create_region', region: REGION, seed: '0', ...hall() })
  const ways = { contained: runner.runProgram, direct: walk }
  const walked = new Set()
  const spent = []
  for (let pair = 0; pair < pairs; pair++) {
    const times = {}
    // Alternate the order: the second walk finds warmer caches.
    for (const name of pair % 2 ? ['contained', 'direct'] : ['direct', 'contained']) {
      await handler.perform({ op: 'apply', region: REGION, ...start, blocks: [] })
      await handler.prepare()
      runner.runProgram = ways[name]
      const before = realNow()
      const { tick, results } = await runner.run(REGION, { [AGENT]: PROGRAM }, TIMEOUT_TICKS)
      times[name] = realNow() - before
      walked.add(`${results[AGENT].ok} after ${tick} ticks`)
    }
    spent.push(times)
  }
  if (walked.size !== 1 || !/^true/.test([...walked])) throw new Error(`the walks ended differently: ${[...walked].join('; ')}`)
  return spent
}

/** Do the same as the program, without a sandbox. */
async function walk ({ bot, scope }) {
  for (const corner of CORNERS) await scope.goToPosition(bot, new Vec3(...corner), 1)
  return { ok: true, error: null, lines: [], log: [], unfinished: [] }
}

/** Return a SNAPSHOT of a floor with one agent on it. @returns {object} */
function hall () {
  const [width, height, depth] = [0, 1, 2].map(axis => BOX[1][axis] - BOX[0][axis] + 1)
  const blocks = new Int32Array(width * height * depth)
  for (let x = 0; x < width; x++) blocks.fill(1, x * height * depth, x * height * depth + depth)
  const agents = {
    [AGENT]: { position: [0.5, FLOOR + 1, 0.5], yaw: 0, pitch: 0, on_ground: true, equipment: {}, inventory: {}, health: 20, food: 20 }
  }
  return { box: BOX, tick: 0, blocks: runsOf(blocks), containers: [], agents, items: {} }
}

module.exports = { measureContainment }
