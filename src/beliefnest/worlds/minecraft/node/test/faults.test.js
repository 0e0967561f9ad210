'use strict'
/** An error inside a bot's own timers and listeners is a fault of the program that runs the bot, and of no other. */
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, inWorld, FLOOR } = require('./plugins/harness')
const { Runner } = require('../src/runner')
const { createSandbox } = require('../src/sandbox')
const { scopeOf } = require('../src/scope')

const both = { sally: agent([0.5, FLOOR, 0.5]), anne: agent([-4.5, FLOOR, 3.5]) }
const sandbox = createSandbox()

/** Run programs in the harness's region, and run `meanwhile` once they have begun. */
async function run (world, programs, meanwhile) {
  const { regions, region } = world
  const here = Object.assign(Object.create(regions), { get: () => region, resumed: (_, action) => action() })
  const runner = new Runner(here, request => sandbox.run(request), scopeOf)
  const done = runner.run('test', programs, 50)
  meanwhile()
  return (await done).results
}

for (const [where, provoke] of [
  ['physics', ({ bots: { sally } }) => sally.once('physicsTick', () => { throw new Error('inside') })],
  ['a packet', ({ bots: { sally } }) => sally._client.once('system_chat', () => { throw new Error('inside') })],
  ['the server', ({ players: { sally } }) => sally._client.once('arm_animation', () => { throw new Error('inside') })],
  ['the server, later', ({ players: { sally } }) => sally._client.once('arm_animation', async () => { await null; throw new Error('inside') })]
]) {
  test(`what is thrown in ${where} ends that agent's program alone`, async () => {
    await inWorld({ agents: both }, async world => {
      const programs = {
        sally: 'await bot.waitForTicks(1)\nbot.swingArm()\nbot.chat("a")\nawait bot.waitForTicks(30)',
        anne: 'await bot.waitForTicks(10)\nbot.chat("fine")'
      }
      const { sally, anne } = await run(world, programs, () => provoke(world))
      assert.deepEqual([sally.ok, sally.error.kind], [false, 'bot'])
      assert.equal(sally.error.message, "the bot of sally failed in the game's own code: inside")
      assert.ok(sally.ticks < 10)
      assert.deepEqual([anne.ok, world.events('chat').at(-1).detail.text], [true, 'fine'])
      const next = await run(world, { sally: 'await goToPosition(bot, new Vec3(3, -51, 3))' }, () => {})
      assert.equal(next.sally.error, null)
    })
  })
}

test('a fault that nobody answers for is raised', async () => {
  await inWorld({ agents: both }, async world => {
    const programs = { sally: 'await bot.waitForTicks(5)', anne: 'await bot.waitForTicks(5)' }
    const failing = () => { setTimeout(() => { throw new Error('ours') }, 60) }
    await assert.rejects(run(world, programs, failing), /^Error: ours$/)
  })
})
