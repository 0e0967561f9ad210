'use strict'
/**
 * Random programs that try to report acts they did not do, to act into a closed cell and to utter texts that are not
 * one line. The events must agree with the state, and a bot must reveal nothing of another branch.
 *
 * BELIEFNEST_NIGHTLY=1 tries hundreds; BELIEFNEST_FUZZ_SEED=17 repeats that seed.
 */
const { Clock } = require('../../src/time/clock')
const { installTime } = require('../../src/time/install')

const clock = new Clock('')
installTime(clock)
require('../../src/prepare').prepare()
const { before, describe, test } = require('node:test')
const assert = require('node:assert/strict')
const { RequestHandler } = require('../../src/requestHandler')
const { kinds } = require('../../src/sandbox/policy/kinds')
const { agent, BOX, floor, statesIn, wholeSnapshot } = require('../harness')
const { generator } = require('./generate')

const FLOOR = BOX[0][1] + 1
const SEEDS = process.env.BELIEFNEST_NIGHTLY === '1' ? 300 : 4
const MOST_TICKS = 200
const AGENTS = ['ann', 'bob', 'cid']
const ITEMS = ['diamond', 'dirt', 'stick']
const CHEST = [3, FLOOR, 3]
// Inside bedrock.
const HIDDEN = [-4, FLOOR, -4]
const FLAWED = ['\n', '\r', '\u2028', '\u2029', '\u0085', '\u001b[2J', '\u0000', '\u009b', 'x'.repeat(250)]

const vector = ([x, y, z]) => `new Vec3(${x}, ${y}, ${z})`
const around = ([x, y, z]) => [-1, 0, 1].flatMap(a => [0, 1].flatMap(b => [-1, 0, 1].map(c => [x + a, y + b, z + c])))
const CELL = around(HIDDEN).filter(place => place.join() !== HIDDEN.join())

/** Return a statement that is independent of all others and may be wrong. */
function statement ({ below, pick, chance }) {
  const other = () => `'${pick(AGENTS)}'`
  const item = () => `'${pick(ITEMS)}'`
  const place = () => [below(23) - 11, FLOOR, below(23) - 11]
  const near = () => HIDDEN.map((value, axis) => value + (axis === 1 ? below(2) : below(3) - 1))
  const words = () => JSON.stringify(`a${chance(50) ? pick(FLAWED) : ''}b${pick(FLAWED)}`)
  const face = () => vector(pick([[0, 1, 0], [0, -1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]]))
  const taken = () => `{ ${pick(ITEMS)}: ${1 + below(3)} }`
  return pick([
    () => `giveItemToOther(bot, ${other()}, ${item()}, ${1 + below(3)})`,
    () => `receiveItemFromOther(bot, ${other()}, ${item()}, ${1 + below(3)})`,
    () => `bot.toss(mcData.itemsByName[${item()}].id, null, ${1 + below(2)})`,
    () => `getItemFromChest(bot, ${vector(CHEST)}, ${taken()})`,
    () => `depositItemIntoChest(bot, ${vector(CHEST)}, ${taken()})`,
    () => `goToPosition(bot, ${vector(place())}, ${pick([0, 2, 5, 30, 1e9])})`,
    () => `goToPosition(bot, new Vec3(${pick([3000, -9, 30])}, ${FLOOR}, ${below(40) - 20}), ${pick([2, 40, 1e9])})`,
    () => `getItemFromChest(bot, ${vector(HIDDEN)}, ${taken()})`,
    () => `bot.openContainer(bot.blockAt(${vector(HIDDEN)}))`,
    () => `bot.activateBlock(bot.blockAt(${vector(near())}), ${face()})`,
    () => `bot.dig(bot.blockAt(${vector(near())}), 'ignore')`,
    () => `bot.placeBlock(bot.blockAt(${vector(near())}), ${face()})`,
    () => `emote(${other()}, ${words()})`, () => `think(bot, ${words()})`, () => `say(bot, ${words()})`, () => `bot.chat(${words()})`,
    () => `whisper(bot, ${other()}, ${words()})`,
    () => `waitTicks(bot, ${1 + below(20)})`
  ])()
}

function program (random) {
  const attempt = () => `(async () => ${statement(random)})().catch(() => {})`
  return Array.from({ length: 2 + random.below(5) }, () => random.chance(40)
    ? `await Promise.all([${attempt()}, ${attempt()}, ${attempt()}, ${attempt()}])`
    : `await ${attempt()}`).join('\n')
}

const READ = `
  const read = (object, names) => Object.fromEntries(names.map((name) => [name, object[name]]))
  const entity = ${JSON.stringify(Object.keys(kinds.entity.get))}
  const own = ${JSON.stringify(Object.keys(kinds.bot.get).filter(name => !['entity', 'entities', 'players', 'player', 'inventory', 'currentWindow', 'pathfinder'].includes(name)))}
  for (const name of own) console.log(name, JSON.stringify(bot[name]))
  for (const each of Object.values(bot.entities)) console.log(JSON.stringify(read(each, entity)))
  console.log(JSON.stringify(Object.entries(bot.players).map(([name, each]) => [name, each.username, each.ping, each.gamemode, each.entity?.id])))
  console.log(JSON.stringify(read(bot.inventory, ['id', 'type', 'slots', 'selectedItem'])), String(bot.currentWindow))
  console.log(JSON.stringify(read(bot.pathfinder, ['thinkTimeout', 'tickTimeout', 'searchRadius'])), bot.pathfinder.isMoving())`

describe('forged at random', () => {
  const frames = []
  let handler

  before(async () => {
    handler = new RequestHandler(clock, ({ frame }) => { if (frame) frames.push(frame) })
    await perform({ op: 'hello', protocol: 6, seed: 0, minecraft: '1.20.4' })
  })

  const perform = request => handler.perform(request)
  const snapshot = region => wholeSnapshot(handler, region)

  function create (region, random) {
    const { serv } = handler.regions
    const blocks = [[...CHEST, 'chest'], [...HIDDEN, 'barrel'], ...CELL.map(place => [...place, 'bedrock'])]
    const place = () => [random.below(6) + 0.5, FLOOR, random.below(2) + 0.5]
    const agents = Object.fromEntries(AGENTS.map(name => [name, agent(place(), { inventory: { diamond: 3, dirt: 4, stick: 2 } })]))
    return perform({
      op: 'create_region', region, seed: region, box: BOX, tick: 0, blocks: floor(blocks.map(([x, y, z, name]) => [x, y, z, serv.blocks.state(name)])),
      containers: [[...CHEST, { diamond: 5, dirt: 5 }], [...HIDDEN, { diamond: 9 }]], agents, items: {}, internal_state: null
    })
  }

  const run = async (region, random) => perform({
    op: 'run', region, programs: Object.fromEntries(AGENTS.map(name => [name, program(random)])), timeout_ticks: 20 + random.below(MOST_TICKS)
  })

  /** Return each agent's gain of items according to events, and the gifts according to both sides. */
  function accounts (events) {
    const gains = {}
    const gifts = { give_item_to_other: {}, receive_item_from_other: {} }
    const signs = { get_item_from_chest: 1, receive_item_from_other: 1, deposit_item_into_chest: -1, give_item_to_other: -1, place_block: -1 }
    for (const { kind, actor, detail } of events.filter(event => event.kind in signs)) {
      const items = detail.items ?? { [detail.block]: 1 }
      for (const [name, count] of Object.entries(items)) {
        const key = `${actor} ${name}`
        gains[key] = (gains[key] ?? 0) + signs[kind] * count
        if (!(kind in gifts)) continue
        const pair = kind === 'give_item_to_other' ? `${actor} ${detail.other} ${name}` : `${detail.other} ${actor} ${name}`
        gifts[kind][pair] = (gifts[kind][pair] ?? 0) + count
      }
    }
    return { gains, gifts }
  }

  /** Check that nobody has more or less than explained by events and by items that it threw and nobody picked up. */
  function checkPossessions (first, last, events) {
    const { gains, gifts } = accounts(events)
    assert.deepEqual(gifts.give_item_to_other, gifts.receive_item_from_other)
    for (const name of ITEMS) {
      const lying = Object.values(last.items).filter(item => item.name === name).reduce((sum, { count }) => sum + count, 0)
      const lost = AGENTS.map(actor => (first.agents[actor].inventory[name] ?? 0) + (gains[`${actor} ${name}`] ?? 0) - (last.agents[actor].inventory[name] ?? 0))
      assert.ok(lost.every(count => count >= 0), `${name}: ${lost}`)
      assert.equal(lost.reduce((sum, count) => sum + count), lying, `${name}: ${lost}`)
    }
  }

  function checkWalks (first, frames) {
    const places = Object.fromEntries(Object.entries(first.agents).map(([name, { position }]) => [name, position]))
    for (const { agents, events } of frames) {
      for (const [name, { position }] of Object.entries(agents)) places[name] = position
      for (const { actor, detail: { destination } } of events.filter(({ kind }) => kind === 'move_to')) {
        const away = Math.hypot(...destination.map((value, axis) => Math.floor(value) - Math.floor(places[actor][axis])))
        assert.ok(away <= 4.5, `${actor} at ${places[actor]} tells of ${destination}`)
      }
    }
  }

  function checkTexts (events) {
    for (const { kind, detail } of events) {
      const text = kind === 'emote' ? detail.name : detail.text
      if (text !== undefined) assert.doesNotMatch(text, /[\u0000-\u001f\u007f-\u009f\u2028\u2029]|^.{257}/, kind)
    }
  }

  function checkCell (first, last) {
    const contents = ({ containers }) => containers.find(([x, y, z]) => [x, y, z].join() === HIDDEN.join())
    assert.deepEqual(contents(last), contents(first))
    const shape = [0, 1, 2].map(axis => BOX[1][axis] - BOX[0][axis] + 1)
    const at = (snapshot, [i, j, k]) => statesIn(snapshot)[(i * shape[1] + j) * shape[2] + k]
    for (const place of [HIDDEN, ...CELL]) {
      const index = place.map((value, axis) => value - BOX[0][axis])
      assert.equal(at(last, index), at(first, index), `(${place}) changed`)
    }
  }

  /** Set a region that ran on to the state of a snapshot. */
  async function returnTo (region, past) {
    const now = await snapshot(region)
    const [before, after] = [now, past].map(snapshot => statesIn(snapshot))
    const shape = [0, 1, 2].map(axis => BOX[1][axis] - BOX[0][axis] + 1)
    const blocks = []
    after.forEach((state, index) => {
      if (state === before[index]) return
      const z = index % shape[2]
      const y = Math.floor(index / shape[2]) % shape[1]
      blocks.push([Math.floor(index / shape[1] / shape[2]) + BOX[0][0], y + BOX[0][1], z + BOX[0][2], state])
    })
    const { tick, containers, agents, items, internal_state: internalState } = past
    await perform({ op: 'apply', region, blocks, containers, agents, items, internal_state: internalState, tick })
  }

  const look = async region => (await perform({ op: 'run', region, programs: Object.fromEntries(AGENTS.map(name => [name, READ])), timeout_ticks: 40 })).results

  const only = process.env.BELIEFNEST_FUZZ_SEED
  for (const seed of only === undefined ? Array.from({ length: SEEDS }, (_, i) => i + 1) : [Number(only)]) {
    test(`acts of seed ${seed}`, async t => {
      const random = generator(seed)
      const region = `acts-${seed}`
      await create(region, random)
      const first = await snapshot(region)
      frames.length = 0
      const { results } = await run(region, random)
      const played = [...frames]
      const last = await snapshot(region)
      const events = played.flatMap(frame => frame.events)
      try {
        checkPossessions(first, last, events)
        checkWalks(first, played)
        checkTexts(events)
        checkCell(first, last)
        for (const { error } of Object.values(results)) assert.ok([null, 'timeout', 'bot'].includes(error?.kind ?? null), JSON.stringify(error))
      } finally {
        await perform({ op: 'destroy_region', region })
      }
      t.diagnostic(`${events.filter(({ kind }) => kind !== 'block_update').length} events`)
    })

    test(`branches of seed ${seed}`, async () => {
      const random = generator(seed + 1000)
      const [region, anew] = [`one-${seed}`, `other-${seed}`]
      await create(region, random)
      const start = await snapshot(region)
      await run(region, random)
      const past = await snapshot(region)
      if (random.chance(50)) await returnTo(region, start)
      await run(region, random)
      await returnTo(region, past)
      await perform({ op: 'create_region', region: anew, seed: region, box: BOX, ...past })
      try {
        const [one, other] = [await look(region), await look(anew)]
        assert.deepEqual(Object.values(one).map(({ error }) => error), AGENTS.map(() => null))
        assert.deepEqual(one, other)
      } finally {
        await perform({ op: 'destroy_region', region })
        await perform({ op: 'destroy_region', region: anew })
      }
    })
  }
})
