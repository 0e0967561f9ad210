'use strict'
const assert = require('node:assert/strict')
const { execFileSync } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')
const { test } = require('node:test')
const { Vec3 } = require('vec3')
const { add } = require('../../bundling/further')
const { writeVersions } = require('../../bundling/versions')
const { commandsFor } = require('../../src/remote/commands')
const { Setup } = require('../../src/remote/setup')
const { BlockMapping, heldFor } = require('../../src/remote/versions')
const { minecraft } = require('../../src/versions')

const registry = version => require('prismarine-registry')(version)
const ours = registry(minecraft)
// Blocks that our version has and the other one lacks.
const NEWER = { '1.20.1': /copper_bulb|copper_door|copper_trapdoor|copper_grate|chiseled_copper|crafter|tuff_|_tuff|trial_spawner/, '1.21.11': /^$/ }

for (const version of Object.keys(NEWER)) {
  test(`blocks of ours are those of the same name in ${version}, and back`, () => {
    const theirs = registry(version)
    const mapping = new BlockMapping(ours, theirs)
    const state = text => {
      const [, name, inner] = /^(\w+)(?:\[(.*)\])?$/.exec(text)
      const properties = Object.fromEntries((inner?.split(',') ?? []).map(each => each.split('=')))
      return require('../../src/server/plugins/lib/states').encode(theirs, name, properties)
    }
    let others = 0
    for (const { name, defaultState, maxStateId } of ours.blocksArray) {
      if (NEWER[version].test(name)) {
        assert.throws(() => mapping.textForServer(defaultState), { kind: 'bad_request', message: new RegExp(`1\\.20\\.1 has no block ${name}`) })
        continue
      }
      for (const own of [defaultState, maxStateId]) {
        const theirs = state(mapping.textForServer(own))
        others += theirs !== own
        assert.equal(mapping.states.text(mapping.fromServer(theirs)), mapping.states.text(own))
      }
    }
    assert.ok(others > 100)
    assert.deepEqual([...mapping.strange], [])
  })
}

test('a block that ours has not is stone, or air where one walks through it', () => {
  const theirs = registry('1.21.11')
  const mapping = new BlockMapping(ours, theirs)
  const name = block => mapping.states.describe(mapping.fromServer(theirs.blocksByName[block].defaultState)).name
  assert.deepEqual(['resin_block', 'firefly_bush'].map(name), ['stone', 'air'])
  assert.deepEqual([...mapping.strange], ['resin_block', 'firefly_bush'])
})

test('whether agents may use blocks is tried with a gate, whatever number its state has', async () => {
  const theirs = registry('1.21.8')
  const mapping = new BlockMapping(ours, theirs)
  const region = { box: { contains: () => true }, toServer: ([x, y, z]) => ({ x, y, z }) }
  const scene = { region, mapping, at: () => ({ name: 'air', properties: { open: true } }) }
  const typed = []
  const operator = { type: command => typed.push(command), until: async condition => condition(), settled: async () => {}, hasSettled: async () => true }
  const bot = { entity: { position: new Vec3(0.5, 1, 0.5) }, _client: { write () {} } }
  const commands = commandsFor(region, state => mapping.textForServer(state), theirs.version)
  await new Setup(scene, operator, commands, theirs).requireUse(bot)
  assert.match(typed[0], /^setblock 0 2 -1 minecraft:oak_fence_gate$/)
  assert.deepEqual(typed.slice(1), ['setblock 0 2 -1 minecraft:air'])
})

test('items and signs are written as the version has them', () => {
  const place = { toServer: ([x, y, z]) => ({ x, y, z }) }
  const of = version => commandsFor(place, () => '', registry(version).version)
  const item = { name: 'bread', count: 2, position: [0.5, 1, 0.5] }
  assert.match(of('1.20.4').layItem(item), /Item:\{id:"minecraft:bread",Count:2b\}/)
  assert.match(of('1.20.6').layItem(item), /Item:\{id:"minecraft:bread",count:2\}/)
  assert.match(of('1.21.4').write([0, 1, 0], 0, "it's"), /set value '"it\\'s"'$/)
  assert.match(of('1.21.5').write([0, 1, 0], 0, "it's"), /set value 'it\\'s'$/)
})

test('a version is spoken by any held one of the same protocol', () => {
  assert.equal(heldFor('1.21.8'), '1.21.8')
  assert.equal(heldFor(765), '1.20.4')
  assert.equal(heldFor('no version'), null)
  assert.equal(heldFor(-7), null)
})

test('further versions are found in folders, and read when asked for', () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'versions-'))
  try {
    execFileSync(process.execPath, [path.join(__dirname, '..', '..', 'bundling', 'versions.js'), folder, '1.21.5'])
    fs.writeFileSync(path.join(folder, 'minecraft-9.9.json.gz'), 'damaged, and never read')
    const versions = { [minecraft]: { language: {} } }
    add(versions, versions[minecraft], [folder])
    assert.deepEqual(Object.keys(versions), [minecraft, '1.21.5', '9.9'])
    assert.equal(versions['1.21.5'].version.minecraftVersion, '1.21.5')
    assert.throws(() => writeVersions(folder, ['0.1']), /has no Minecraft 0\.1/)
  } finally {
    fs.rmSync(folder, { recursive: true })
  }
})
