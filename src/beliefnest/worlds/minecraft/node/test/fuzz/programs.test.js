'use strict'
/**
 * Random programs of several agents in one region, ended at random moments. Whatever they do, items are conserved,
 * nothing leaves the region, frames report what happened, and the next program runs.
 *
 * BELIEFNEST_NIGHTLY=1 runs thousands; BELIEFNEST_FUZZ_SEED=17 repeats those of one seed.
 */
const { Clock } = require('../../src/time/clock')
const { installTime } = require('../../src/time/install')

const clock = new Clock('')
installTime(clock)
require('../../src/prepare').prepare()
const { before, describe, test } = require('node:test')
const assert = require('node:assert/strict')
const { RequestHandler } = require('../../src/requestHandler')
const { agent, BOX, floor, statesIn, wholeSnapshot } = require('../harness')
const { materials, mayBeMissing, unexplained, worthTable } = require('./balance')
const { AGENTS, Writer, generator } = require('./generate')

const FLOOR = BOX[0][1] + 1
const BOXED = [BOX[0], [BOX[1][0], BOX[1][1] + 1, BOX[1][2]]]
const SEEDS = process.env.BELIEFNEST_NIGHTLY === '1' ? 250 : 3
const RUNS = 5
const SETTLING_TICKS = 60
const FURNACES = [[5, FLOOR, -4, 'furnace'], [-7, FLOOR, 5, 'smoker']]
const BLOCKS = [
  ...FURNACES,
  [3, FLOOR, 3, 'chest', { type: 'right', facing: 'south' }], [4, FLOOR, 3, 'chest', { type: 'left', facing: 'south' }],
  [-5, FLOOR, -2, 'barrel'], [-3, FLOOR, 4, 'crafting_table'], [0, FLOOR, 7, 'lever', { face: 'floor', powered: false }],
  [7, FLOOR, 0, 'red_bed', { part: 'foot', facing: 'east' }], [8, FLOOR, 0, 'red_bed', { part: 'head', facing: 'east' }],
  [2, FLOOR, -6, 'oak_log'], [2, FLOOR + 1, -6, 'oak_log'], [-8, FLOOR, -8, 'sand'], [-8, FLOOR + 1, -8, 'sand'], [6, FLOOR, 6, 'glass'],
  [-2, FLOOR, -8, 'stone'], [-2, FLOOR + 1, -8, 'torch'], [9, FLOOR, -9, 'oak_door', { half: 'lower' }], [9, FLOOR + 1, -9, 'oak_door', { half: 'upper' }]
]
const CONTAINERS = [[3, FLOOR, 3, { apple: 100, diamond: 5, stick: 3 }], [-5, FLOOR, -2, { dirt: 200 }], [5, FLOOR, -4, { raw_iron: 2 }]]
const INVENTORIES = {
  sally: { oak_log: 20, dirt: 70, diamond: 3, coal: 5, stone_pickaxe: 1, bread: 3 },
  anne: { oak_planks: 12, apple: 9, raw_iron: 5, wooden_pickaxe: 1, red_bed: 1, torch: 4, sand: 3 },
  bob: { cobblestone: 20, stick: 9, iron_helmet: 1, lever: 2, oak_door: 1, glass: 2, crafting_table: 1, coal: 2 }
}
const START = { sally: [0.5, FLOOR, 0.5], anne: [-4.5, FLOOR, 0.5], bob: [4.5, FLOOR, -8.5] }

const plain = ({ blocks, ...rest }) => JSON.parse(JSON.stringify({ ...rest, blocks: Array.from(blocks instanceof Uint8Array ? statesIn({ blocks }, BOXED) : blocks) }))

describe('random programs', () => {
  const frames = []
  let handler
  let serv
  let worth
  let bystanders

  before(async () => {
    handler = new RequestHandler(clock, ({ frame }) => { if (frame) frames.push(frame) })
    await perform({ op: 'hello', protocol: 6, seed: 0, minecraft: '1.20.4' })
    serv = handler.regions.serv
    worth = worthTable(serv.registry)
    await create('bystanders', 'bystanders', { sally: START.sally })
    bystanders = plain(await wholeSnapshot(handler, 'bystanders'))
  })

  const perform = request => handler.perform(request)

  function create (region, seed, places = START) {
    const states = BLOCKS.map(([x, y, z, name, properties]) => [x, y, z, serv.blocks.state(name, properties)])
    const agents = Object.fromEntries(Object.entries(places).map(([name, place]) => [name, agent(place, { inventory: INVENTORIES[name], food: 8 })]))
    return perform({ op: 'create_region', region, seed, box: BOXED, tick: 0, blocks: floor(states, BOXED), containers: CONTAINERS, agents, items: {}, internal_state: null })
  }

  /** Apply frames to a snapshot. Items are compared by content, because numbers differ between regions. */
  function fold (snapshot, frames) {
    const state = { ...plain(snapshot) }
    const shape = [0, 1, 2].map(axis => BOXED[1][axis] - BOXED[0][axis] + 1)
    const containers = new Map(state.containers.map(entry => [entry.slice(0, 3).join(), entry]))
    const change = (table, changes) => Object.entries(changes).forEach(([key, value]) => {
      if (value === null) delete table[key]
      else table[key] = value
    })
    for (const frame of frames.map(plain)) {
      change(state.agents, frame.agents)
      change(state.items, frame.items)
      for (const [x, y, z, id] of frame.blocks) {
        const [i, j, k] = [x, y, z].map((value, axis) => value - BOXED[0][axis])
        state.blocks[(i * shape[1] + j) * shape[2] + k] = id
      }
      for (const [x, y, z, items] of frame.containers) {
        if (items === null) containers.delete([x, y, z].join())
        else containers.set([x, y, z].join(), [x, y, z, items])
      }
    }
    state.containers = [...containers.values()].sort((a, b) => a[0] - b[0] || a[1] - b[1] || a[2] - b[2])
    return state
  }

  /** Check that barriers surround a region's box and nothing is beyond them. */
  function surroundings (region) {
    const differences = new Set()
    const { box, origin, columns } = region
    const grown = box.grown()
    for (const [chunkX, chunkZ] of columns) {
      const column = serv.overworld.sync.getColumn(chunkX, chunkZ)
      for (let x = 0; x < 16; x++) {
        for (let z = 0; z < 16; z++) {
          for (let y = grown.low[1] - 2; y <= grown.high[1] + 2; y++) {
            const [sx, sz] = [chunkX * 16 + x - origin.x, chunkZ * 16 + z - origin.z]
            if (box.contains(sx, y, sz)) continue
            const { name } = serv.blocks.describe(column.getBlockStateId({ x, y, z }))
            const expected = grown.contains(sx, y, sz) ? 'barrier' : 'air'
            if (name !== expected) differences.add(`${name} at (${sx}, ${y}, ${sz})`)
          }
        }
      }
    }
    return [...differences]
  }

  const counted = items => {
    const counts = {}
    for (const { name, count } of items) counts[name] = (counts[name] ?? 0) + count
    return Object.fromEntries(Object.entries(counts).sort())
  }
  const LOOK = `
    await waitTicks(bot, 1)
    console.log(JSON.stringify(bot.inventory.slots.filter(Boolean).map(({ name, count }) => ({ name, count }))))
    console.log(String(bot.currentWindow))
    console.log(JSON.stringify(bot.entity.position))`

  /** Check that an ordinary program runs afterwards, and that its bot knows its possessions and its position. */
  async function checkMinds (region) {
    // By now tossed items can be picked up; no pickup happens in the tick in which bots look.
    await perform({ op: 'step', region, ticks: SETTLING_TICKS })
    const { results } = await perform({ op: 'run', region, programs: Object.fromEntries(AGENTS.map(name => [name, LOOK])), timeout_ticks: 40 })
    const { agents } = await wholeSnapshot(handler, region)
    for (const name of AGENTS) {
      const { ok, error, log } = results[name]
      assert.deepEqual([ok, error], [true, null], name)
      assert.deepEqual(counted(JSON.parse(log[0])), agents[name].inventory, `what ${name} believes to have, and has`)
      assert.equal(log[1], 'null')
    }
  }

  async function checkRun (region, random) {
    const programs = Object.fromEntries(AGENTS.filter(() => random.chance(80)).map(name => [name, new Writer(random, BLOCKS, Object.keys(INVENTORIES[name])).program()]))
    const timeout = 1 + random.below(random.chance(35) ? 60 : 400)
    const first = await wholeSnapshot(handler, region)
    frames.length = 0
    const { results } = await perform({ op: 'run', region, programs, timeout_ticks: timeout })
    const played = [...frames]
    const last = await wholeSnapshot(handler, region)
    try {
      assert.deepEqual(played.filter(frame => frame.region !== region), [], 'frames of other regions')
      // Frames do not contain the internal state.
      const { tick, internal_state: internalState } = plain(last)
      assert.deepEqual({ ...fold(first, played), tick, internal_state: internalState }, plain(last))
      const food = Object.fromEntries(Object.entries(first.agents).map(([name, state]) => [name, state.food]))
      const missing = mayBeMissing(worth, played, food, last.tick - first.tick, FURNACES.length + 1)
      const describe = state => serv.blocks.describe(state)
      assert.deepEqual(unexplained(materials(worth, first, describe), materials(worth, last, describe), missing), [])
      for (const { position } of Object.values(last.agents)) {
        assert.ok(position.every((value, axis) => value >= BOXED[0][axis] && value <= BOXED[1][axis] + 1), `somebody is at ${position}`)
      }
      assert.deepEqual(surroundings(handler.regions.get(region)), [], 'around the region')
      await checkMinds(region)
    } catch (error) {
      error.message = `${error.message}\nafter ${timeout} ticks of ${JSON.stringify(programs, null, 1).replaceAll('\\n', '\n')}\nwhich gave ${JSON.stringify(results)}`
      throw error
    }
    return { programs: Object.keys(programs).length, acts: played.flatMap(({ events }) => events).filter(({ kind }) => kind !== 'block_update').length }
  }

  const only = process.env.BELIEFNEST_FUZZ_SEED
  const seeds = only === undefined ? Array.from({ length: SEEDS }, (_, i) => i + 1) : [Number(only)]
  for (const seed of seeds) {
    test(`of seed ${seed}`, async t => {
      const random = generator(seed)
      const name = `fuzz-${seed}`
      await create(name, name)
      const total = { programs: 0, acts: 0 }
      try {
        for (let run = 0; run < RUNS; run++) {
          const { programs, acts } = await checkRun(name, random)
          total.programs += programs
          total.acts += acts
        }
        assert.deepEqual(plain(await wholeSnapshot(handler, 'bystanders')), bystanders, 'another region')
      } finally {
        await perform({ op: 'destroy_region', region: name })
      }
      t.diagnostic(`${total.programs} programs, ${total.acts} acts`)
    })
  }
})
