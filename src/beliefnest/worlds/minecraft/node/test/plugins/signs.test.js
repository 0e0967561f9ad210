'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { inWorld, agent, FLOOR, Vec3 } = require('./harness')
const { applySigns } = require('../../src/regions/changes')
const { signStates } = require('../../src/regions/facts')

const PLACE = [2, FLOOR, 0]
const SIGN = { blocks: [[...PLACE, 'oak_sign']] }
const TWO = { agents: { sally: agent([0.5, FLOOR, 0.5]), anne: agent([4.5, FLOOR, 0.5]) } }

const signOf = (bot, place = PLACE) => bot.blockAt(new Vec3(...place))
const textsOf = world => Object.values(world.bots).map(bot => signOf(bot).getSignText()[0].replace(/\n+$/, ''))

async function write (world, text, name = 'sally') {
  const bot = world.bots[name]
  await world.during(bot.activateBlock(signOf(bot)))
  bot.updateSign(signOf(bot), text)
  await world.ticks(2)
}

test('who uses a sign can write on it once, and everybody reads it', async () => {
  await inWorld({ ...TWO, ...SIGN }, async world => {
    await write(world, 'way\n\nout')
    assert.deepEqual(textsOf(world), ['way\n\nout', 'way\n\nout'])
    world.bots.sally.updateSign(signOf(world.bots.sally), 'again')
    world.bots.anne.updateSign(signOf(world.bots.anne), 'mine')
    await world.ticks(2)
    assert.deepEqual(textsOf(world), ['way\n\nout', 'way\n\nout'])
    const rows = world.frames.flatMap(frame => frame.blocks)
    const state = world.block(...PLACE).stateId
    assert.deepEqual(rows, [[...PLACE, state, 'way\n\nout']])
    const updates = world.frames.flatMap(frame => frame.events).filter(({ kind }) => kind === 'block_update')
    assert.deepEqual(updates, [{
      kind: 'block_update',
      actor: 'sally',
      detail: { position: PLACE, block: world.serv.blocks.text(state), text: 'way\n\nout' }
    }])
  })
})

test('what no sign can hold is not written', async () => {
  await inWorld(SIGN, async world => {
    const { sally } = world.bots
    for (const text1 of ['x'.repeat(46), 'a\u001bb', 'a\u2028b', '\ud800']) {
      await world.during(sally.activateBlock(signOf(sally)))
      sally._client.write('update_sign', { location: new Vec3(...PLACE), isFrontText: true, text1, text2: '', text3: '', text4: '' })
      await world.ticks(1)
    }
    await world.during(sally.activateBlock(signOf(sally)))
    sally.updateSign(signOf(sally), 'behind', true)
    await world.ticks(1)
    assert.equal(world.serv.signs.get(world.at(...PLACE)), '')
  })
})

test('a text goes with its sign, and stays while only the state of the sign changes', async () => {
  await inWorld(SIGN, async world => {
    const { serv, region } = world
    await write(world, 'here')
    const put = name => serv.blocks.put(world.at(...PLACE), serv.blocks.state(...name))
    put(['oak_sign', { rotation: 4 }])
    await world.ticks(1)
    assert.deepEqual(world.frames.at(-1).blocks[0].slice(4), ['here'])
    put(['stone'])
    put(['oak_sign'])
    await world.ticks(1)
    assert.deepEqual(textsOf(world), [''])
    assert.deepEqual(world.frames.at(-1).blocks[0].length, 4)
    assert.deepEqual(signStates(serv, region), [])
  })
})

test('regions are made and changed with what is written, and bots that come read it', async () => {
  await inWorld(SIGN, async world => {
    const { serv, region, regions } = world
    const become = signs => {
      applySigns(serv, region, signs)
      return signStates(serv, region)
    }
    assert.deepEqual(become([[...PLACE, 'told']]), [[...PLACE, 'told']])
    await regions.bodies.replace(region, {})
    const { bot } = region.bodies.get('sally')
    assert.equal(signOf(bot).getSignText()[0].trimEnd(), 'told')
    assert.deepEqual(become([]), [])
    assert.throws(() => become([[2, FLOOR, 1, 'x']]), /sign at \(2, -51, 1\): there is no sign, but air/)
  })
})
