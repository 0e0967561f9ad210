'use strict'
const test = require('node:test')
const assert = require('node:assert/strict')
const fs = require('node:fs')
const { SKILLS } = require('../../../../../skills/code')
const { OUTPUTS } = require('../../../../../skills/code/generate')

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

test('a signature names the skill and its parameters, and the example is a program that calls it', () => {
  const AsyncFunction = (async () => {}).constructor
  for (const { name, signature, parameters, example } of SKILLS) {
    const listed = signature.replace(/=("[^"]*"|[^,)]+)/g, '')
    assert.equal(listed, `${name}(${parameters.map(parameter => parameter.name).join(', ')})`)
    assert.ok(example.includes(`${name}(`))
    assert.doesNotThrow(() => new AsyncFunction(example))
  }
})
