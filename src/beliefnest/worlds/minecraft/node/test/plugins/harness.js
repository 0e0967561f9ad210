'use strict'
/** Worlds with real bots on the real server, in memory under virtual time, in this process. */
const { Clock } = require('../../src/time/clock')
const { installTime } = require('../../src/time/install')

const clock = new Clock('')
installTime(clock)
require('../../src/prepare').prepare()
const { Vec3 } = require('vec3')
const { rememberBlocks } = require('../../src/blocks')
const { Regions } = require('../../src/regions/regions')
const { createServer } = require('../../src/server')
const { Random } = require('../../src/time/random')
const versions = require('../../src/versions')
const { agent, floor, BOX } = require('../harness')
const { everything } = require('./everything')

const registry = require('prismarine-registry')(versions.minecraft)
registry.loadDimensionCodec(registry.loginPacket.dimensionCodec)
rememberBlocks(registry)

const FLOOR = BOX[0][1] + 1
const LIMIT = 2000

/**
 * Run `body(world)` in a region with a stone floor.
 * @param {object} setting `agents` (AGENT by name), `blocks` ([x, y, z, name, properties]),
 *   `containers` ([x, y, z, ITEMS]), `box` (inclusive corners)
 */
async function inWorld ({ agents = { sally: agent([0.5, FLOOR, 0.5]) }, blocks = [], containers = [], box = BOX }, body) {
  const frames = []
  clock.root.random = new Random('0')
  const serv = createServer(registry)
  const regions = new Regions(serv, clock, frame => frames.push(frame), () => {})
  const states = blocks.map(([x, y, z, name, properties]) => [x, y, z, serv.blocks.state(name, properties)])
  await regions.create({
    region: 'test', seed: 'test', box, tick: 0, blocks: floor(states, box), containers, agents, items: {}, internal_state: null
  })
  await regions.inside(regions.get('test'), () => body(worldOf(regions, frames)))
}

function worldOf (regions, frames) {
  const region = regions.get('test')
  const { serv } = regions
  const at = (x, y, z) => region.toServer([x, y, z])

  async function until (condition) {
    for (let count = 0; !await condition(); count++) {
      if (count === LIMIT) throw new Error(`not within ${LIMIT} ticks: ${condition}`)
      await regions.tick(region)
    }
  }
  /** Let time pass until a promise is settled. Return its outcome. */
  async function during (promise) {
    let settled = false
    const done = () => { settled = true }
    promise.then(done, done)
    await until(() => settled)
    return promise
  }
  async function ticks (number) {
    for (let count = 0; count < number; count++) await regions.tick(region)
  }
  const bots = Object.fromEntries([...region.bodies].map(([name, { bot }]) => [name, bot]))
  const players = Object.fromEntries([...region.bodies].map(([name, { player }]) => [name, player]))
  const events = (...kinds) => frames.flatMap(frame => frame.events)
    .filter(({ kind }) => kind !== 'block_update' && (kinds.length === 0 || kinds.includes(kind)))
  return {
    serv, regions, region, bots, players, frames, events, until, during, ticks, at,
    container: (x, y, z) => serv.containers.get(at(x, y, z)),
    block: (x, y, z) => serv.blocks.at(at(x, y, z)),
    has: name => players[name].possessions().inventory,
    everything: () => everything(serv, () => true)
  }
}

module.exports = { agent, inWorld, FLOOR, Vec3 }
