'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { agent, failure, withSkills, FLOOR, Vec3 } = require('./harness')

const PLACE = [4, FLOOR, -3]
const SIGN = new Vec3(...PLACE)
const BLOCKS = [[...PLACE, 'oak_sign']]
const AGENTS = { sally: agent([0.5, FLOOR, 0.5]), anne: agent([-5.5, FLOOR, 0.5]) }

test('a sign is written on and read, by skills and by Mineflayer\'s own calls', async () => {
  await withSkills({ agents: AGENTS, blocks: BLOCKS }, async world => {
    const { bots: { sally, anne }, skills } = world
    assert.equal(await world.during(skills.anne.readSign(anne, SIGN)), '')
    await world.during(skills.sally.writeSign(sally, SIGN, 'tools\nno food\n'))
    await world.until(async () => await world.during(skills.anne.readSign(anne, SIGN)) === 'tools\nno food')
    const results = await world.run({
      sally: `
        const sign = bot.blockAt(new Vec3(${PLACE}))
        if (sign.getSignText()[0] !== 'tools\\nno food') throw new Error(JSON.stringify(sign.getSignText()))
        const opened = new Promise(resolve => bot.once('signOpen', resolve))
        await bot.activateBlock(sign)
        bot.updateSign(await opened, 'food')
        await waitUntil(bot, () => bot.blockAt(sign.position).getSignText()[0] === 'food', 40)
        console.log(await readSign(bot, sign.position))`,
      anne: 'await writeSign(bot, bot.entity.position, "x")'
    })
    assert.deepEqual([results.sally.error, results.sally.log], [null, ['food']])
    assert.match(results.anne.error.message, /writeSign: there is no sign at \(-6, -51, 0\), but air/)
  })
})

test('who writes on a sign tells beforehand what the text claims', async () => {
  await withSkills({ agents: AGENTS, blocks: BLOCKS }, async world => {
    const { bots: { sally }, skills: { sally: own } } = world
    const claims = [{ kind: 'located', item: 'diamond', place: new Vec3(0.5, -50, 3.5) }]
    await world.during(own.writeSign(sally, SIGN, ['tools', 'no food'], claims))
    const expected = [{ kind: 'located', item: 'diamond', place: [0, -50, 3] }]
    assert.deepEqual(world.emitted.filter(({ kind }) => kind === 'claims'), [
      { actor: 'sally', kind: 'claims', detail: { text: 'tools\nno food', position: PLACE, claims: expected } }
    ])
    assert.match((await failure(world, own.writeSign(sally, SIGN, '', claims))).message, /empty text cannot claim/)
    assert.match((await failure(world, own.writeSign(sally, SIGN, 'x', 'y'))).message, /must be a list/)
  })
})

test('what does not fit on a sign is refused by name', async () => {
  await withSkills({ agents: AGENTS, blocks: BLOCKS }, async world => {
    const { bots: { sally }, skills } = world
    const refused = async text => (await failure(world, skills.sally.writeSign(sally, SIGN, text))).message
    assert.match(await refused('1\n2\n3\n4\n5'), /at most 4 lines; it has 5/)
    assert.match(await refused(`a\n${'x'.repeat(46)}`), /at most 45 characters; line 2 has 46/)
    assert.match(await refused('a\u001b'), /without control characters/)
    assert.match(await refused(7), /text must be a text; it is 7/)
    const { sally: result } = await world.run({ sally: `bot.updateSign(bot.blockAt(new Vec3(${PLACE})), "x".repeat(46))` })
    assert.match(result.error.message, /at most 45 characters/)
  })
})
