'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const { failure, withSkills, FLOOR, Vec3 } = require('./harness')

const PLACE = [4, FLOOR, 4]
const button = name => ({ blocks: [[...PLACE, name, { face: 'floor', powered: false }]] })

for (const name of ['stone_button', 'oak_button']) {
  test(`a ${name} is pressed, each time anew`, async () => {
    await withSkills(button(name), async world => {
      const { bots: { sally }, skills } = world
      for (let time = 0; time < 2; time++) await world.during(skills.sally.pressButton(sally, new Vec3(...PLACE)))
      const states = (await world.events('block_update')).map(({ detail }) => /powered=\w+/.exec(detail.block)[0])
      assert.deepEqual(states.slice(0, 3), ['powered=true', 'powered=false', 'powered=true'])
      assert.deepEqual((await world.events('press_button')).map(({ actor, detail }) => [actor, detail.position]),
        [['sally', PLACE], ['sally', PLACE]])
    })
  })
}

test('what is no button is named', async () => {
  await withSkills({}, async world => {
    const { bots: { sally }, skills } = world
    const error = await failure(world, skills.sally.pressButton(sally, new Vec3(0, FLOOR - 1, 3)))
    assert.equal(error.skill, 'pressButton')
    assert.match(error.message, /no button at \(0, -52, 3\), but stone/)
  })
})
