'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { stopBot } = require('../../src/bots/bot')
const { agent, withSkills, FLOOR, Vec3 } = require('./harness')

const CHESTS = [[3, FLOOR, 3], [4, FLOOR, 3], [-5, FLOOR, -2]]
const TABLE = [-3, FLOOR, 4]
const STEPS = 60
// Sixty skills take minutes of real time.
const TOO_LONG = process.env.BELIEFNEST_SKILLS_OVER === 'tcp' && process.env.BELIEFNEST_NIGHTLY !== '1'
/** Worth of things in planks: crafting changes kinds, never the worth. */
const WORTH = { oak_log: 4, oak_planks: 1, stick: 0.5, crafting_table: 4, chest: 8 }
const PLACED = ['dirt', 'oak_log']

const setting = {
  agents: {
    sally: agent([0.5, FLOOR, 0.5], { inventory: { oak_log: 20, dirt: 70, diamond: 3 } }),
    anne: agent([-4.5, FLOOR, 3.5], { inventory: { oak_planks: 12, apple: 9 } })
  },
  blocks: [
    [...CHESTS[0], 'chest', { type: 'right', facing: 'south' }], [...CHESTS[1], 'chest', { type: 'left', facing: 'south' }],
    [...CHESTS[2], 'barrel'], [...TABLE, 'crafting_table']
  ],
  containers: [[...CHESTS[0], { apple: 100, diamond: 5, stick: 3 }], [...CHESTS[2], { dirt: 200 }]]
}

function generator (seed) {
  let state = seed
  const below = n => {
    state = (Math.imul(state, 1103515245) + 12345) >>> 0
    return Math.floor(state / 65536) % n
  }
  return { below, pick: list => list[below(list.length)] }
}

/** Return the worth of all wood and the counts of everything else, placed blocks included. */
async function balance (world) {
  const total = { wood: 0 }
  const add = (name, count) => {
    if (name in WORTH) total.wood += WORTH[name] * count
    else total[name] = (total[name] ?? 0) + count
  }
  Object.entries(await world.everything()).forEach(([name, count]) => add(name, count))
  Object.entries(await world.countBlocks(PLACED)).forEach(([name, count]) => add(name, count))
  return Object.entries(total).sort()
}

function randomCall ({ below, pick }, other) {
  const item = pick(['oak_log', 'oak_planks', 'stick', 'dirt', 'diamond', 'apple'])
  const chest = new Vec3(...pick(CHESTS))
  const spot = new Vec3(below(9) - 4, FLOOR, below(9) - 8)
  return pick([
    ['getItemFromChest', chest, { [item]: 1 + below(80) }],
    ['getItemFromChest', chest, { [item]: 1 + below(5), apple: 1 + below(20) }],
    ['depositItemIntoChest', chest, { [item]: 1 + below(60) }],
    ['depositItemIntoChest', chest, { dirt: 1 + below(90), [item]: 1 }],
    ['craftItem', 'oak_planks', null, 1 + below(12)],
    ['craftItem', 'stick', null, 1 + below(8)],
    ['craftItem', 'chest', new Vec3(...TABLE), 1],
    ['giveItemToOther', other, item, 1 + below(4)],
    ['placeItem', pick(PLACED), spot],
    ['mineBlock', spot, pick(PLACED)],
    ['equip', item, pick(['hand', 'off-hand', 'head'])],
    ['goToPosition', spot]
  ])
}

for (const seed of [1, 2]) {
  test(`skills conserve items, whether they end, fail or are stopped (seed ${seed})`, { skip: TOO_LONG }, async () => {
    await withSkills(setting, async world => {
      const random = generator(seed)
      const before = await balance(world)
      const done = new Map()
      for (let step = 0; step < STEPS; step++) {
        const name = random.pick(['sally', 'anne'])
        const bot = world.bots[name]
        const [skill, ...args] = randomCall(random, name === 'sally' ? 'anne' : 'sally')
        const run = world.skills[name][skill](bot, ...args).then(() => done.set(skill, (done.get(skill) ?? 0) + 1), error => assert.equal(error.skill, skill))
        if (random.below(3) === 0) {
          await world.ticks(1 + random.below(40))
          stopBot(bot)
        }
        await world.during(run)
        await world.ticks(1)
        assert.deepEqual(await balance(world), before, `${step}: ${name} ${skill} ${JSON.stringify(args)}`)
      }
      if (world.isVirtual) assert.ok(done.size >= 6, `too few kinds of skills succeeded: ${[...done.keys()]}`)
    })
  })
}
