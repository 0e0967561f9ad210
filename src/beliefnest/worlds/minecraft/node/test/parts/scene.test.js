'use strict'
/** Attribution of a remote server's block changes to the agents who caused them. */
require('../../src/prepare').prepare()
const assert = require('node:assert/strict')
const { test } = require('node:test')
const { Vec3 } = require('vec3')
const { Box } = require('../../src/regions/box')
const { Terrain } = require('../../src/regions/terrain')
const { BlockMapping } = require('../../src/remote/versions')
const { Scene } = require('../../src/remote/scene')
const { Witness } = require('../../src/remote/witness')
const { minecraft } = require('../../src/versions')

const registry = require('prismarine-registry')(minecraft)
const { encode } = require('../../src/server/plugins/lib/states')
const Item = require('prismarine-item')(registry)
const LOWER = new Vec3(0, 0, 0)

const half = (name, open) => encode(registry, 'oak_door', { half: name, open: String(open) })

/** Return a place with a shut door, and the list of its recorded events. */
function place () {
  const box = new Box([0, 0, 0], [0, 1, 0])
  const events = []
  const recorder = { blockChanged () {}, event: ({ kind, actor, detail }) => events.push([kind, actor, detail.open]) }
  const region = { box, recorder, tick: 0, followed: 0, toServer: ([x, y, z]) => new Vec3(x, y, z), emit () {} }
  const scene = new Scene(region, new BlockMapping(registry, registry), {}, {}, async () => null)
  scene.settle(Terrain.of(Int32Array.from([half('lower', false), half('upper', false)]), box))
  const witness = new Witness('sally', region, scene, Item)
  witness.bot = { entity: { position: new Vec3(0.5, 0, 0.5) } }
  scene.witnesses.set('sally', witness)
  return { scene, witness, events }
}

for (const order of [['lower', 'upper'], ['upper', 'lower']]) {
  test(`a door is told of as often as it was used, also when the ${order[1]} half is heard of after the next use`, () => {
    const { scene, witness, events } = place()
    const change = (name, open) => scene.blockChanged(name === 'upper' ? LOWER.offset(0, 1, 0) : LOWER, half(name, open))
    witness.use({ location: LOWER })
    change(order[0], true)
    // The agent's bot has seen the open door, and shuts it.
    witness.use({ location: LOWER })
    change(order[1], true)
    for (const name of order) change(name, false)
    scene.endTick()
    assert.deepEqual(events, [['use_door', 'sally', true], ['use_door', 'sally', false]])
  })
}

test('a bot that is on its way back is where it stood', () => {
  const { witness } = place()
  witness.stoodAt = new Vec3(3, 1, 4)
  witness.bot = { entity: undefined }
  assert.deepEqual(witness.position, new Vec3(3, 1, 4))
})

test('a click is remembered for as many ticks as this process follows', () => {
  const { witness, witness: { windows, region } } = place()
  windows.open({ windowId: 1 })
  windows.opened.own.set(0, { before: null, after: [], at: witness.followed, sent: undefined })
  region.tick += 1000
  region.followed += 1
  windows.forgetClicks()
  assert.equal(windows.opened.own.size, 1)
  region.followed += 20
  windows.forgetClicks()
  assert.equal(windows.opened.own.size, 0)
})
