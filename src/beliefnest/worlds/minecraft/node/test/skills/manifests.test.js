'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const fs = require('node:fs')
const { SKILLS } = require('../../../../../skills/code')
const { OUTPUTS } = require('../../../../../skills/code/generate')
const { aimOfSkill } = require('../../src/sandbox/aims')
const { COST } = require('../../src/sandbox/policy/kinds')

const PUBLISHED = [
  'goToPosition(bot, position, dist=2)', 'getItemFromChest(bot, chestPosition, items)',
  'depositItemIntoChest(bot, chestPosition, items)', 'mineBlock(bot, position, name)',
  'placeItem(bot, name, position)', 'craftItem(bot, name, craftingTablePos, count)',
  'smeltItem(bot, itemName, fuelName, furnacePos, count)', 'turnOnLever(bot, position)',
  'turnOffLever(bot, position)', 'giveItemToOther(bot, otherName, item, num)',
  'receiveItemFromOther(bot, otherName, item, num)', 'exploreUntil(bot, direction, maxDistance, callback)',
  'givePlacedItemBack(bot, name, position)', 'waitForMobRemoved(bot, entity, timeout)', 'think(bot, msg)',
  'doNothing(bot)', 'emote(name, type)', 'checkValidPosition(position, bot)'
]

for (const { file, text } of OUTPUTS) {
  test(`${file.split('/').at(-1)} is what generate.js makes of the skills`, () => {
    assert.equal(fs.readFileSync(file, 'utf8'), text())
  })
}

test('the published skills have their published signatures', () => {
  const signatures = SKILLS.map(({ signature }) => signature)
  assert.deepEqual(PUBLISHED.filter(signature => !signatures.includes(signature)), [])
})

test('the example is a program that calls the skill', () => {
  const AsyncFunction = (async () => {}).constructor
  for (const { name, example } of SKILLS) {
    assert.ok(example.includes(`${name}(`))
    assert.doesNotThrow(() => new AsyncFunction(example))
  }
})

test('a skill has one target at most, a position or an agent, and a price that there is', () => {
  for (const { name, parameters, cost = 'call' } of SKILLS) {
    const targets = parameters.filter(({ aim }) => aim !== undefined)
    assert.ok(targets.length <= 1 && targets.every(({ aim, type }) => ['walks', 'uses'].includes(aim) && /^Vec3|^string$/.test(type)), name)
    assert.ok(Object.hasOwn(COST, cost), name)
  }
})

test('the targets of calls are noted: signs, beds and placed items too, but no value of another type', () => {
  const place = { x: 1, y: 2, z: 3 }
  for (const [name, args] of [['writeSign', [place, 'a']], ['sleep', [place]], ['givePlacedItemBack', ['chest', place]]]) {
    assert.deepEqual(aimOfSkill(name, [null, ...args]), { call: name, place: [1, 2, 3], agent: null, uses: true })
  }
  assert.equal(aimOfSkill('openDoor', [null, 'anne']), null)
  assert.equal(aimOfSkill('follow', [null, place]), null)
  assert.equal(aimOfSkill('lookAt', [null, place]), null)
})
