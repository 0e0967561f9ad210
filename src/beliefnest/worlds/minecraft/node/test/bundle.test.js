'use strict'
const assert = require('node:assert/strict')
const { execFileSync } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')
const { after, before, describe, it } = require('node:test')
const { gunzipSync } = require('node:zlib')
const { decode } = require('@msgpack/msgpack')
const { Node, region } = require('./harness')
const { scopeOf } = require('../src/scope')

const BUILD = path.join(__dirname, '..', 'build.js')
const LIMIT_BYTES = 12e6

describe('the bundle', () => {
  let folder
  before(() => {
    folder = fs.mkdtempSync(path.join(os.tmpdir(), 'bundle-'))
    execFileSync(process.execPath, [BUILD, folder])
  })
  after(() => fs.rmSync(folder, { recursive: true }))

  it('runs by itself, far from node_modules, allowed to read nothing but itself', async () => {
    const node = new Node(path.join(folder, 'main.js'), ['--permission', `--allow-fs-read=${folder}`, '--allow-worker'])
    const versions = await node.hello()
    assert.equal(versions.minecraft, '1.20.4')
    await node.request('create_region', region('a'))
    const { results } = await node.request('run', {
      region: 'a', timeout_ticks: 400, programs: { sally: 'await goToPosition(bot, new Vec3(5, -51, 5))' }
    })
    assert.deepEqual(results.sally.error, null)
    assert.ok(node.frames.length > 10)
    node.child.stdio[4].destroy()
    assert.deepEqual(await node.exited, { code: null, signal: 'SIGKILL' })
  })

  it('does as the sources do, with the same seed', async () => {
    const frames = []
    const roam = 'for (let i = 0; i < 3; i++) { await goToPosition(bot, new Vec3(Math.floor(Math.random() * 9), -51, 3), 1); bot.chat(String(Math.random())) }'
    for (const main of [path.join(folder, 'main.js'), undefined]) {
      const node = new Node(main)
      await node.hello(5)
      await node.request('create_region', region('a'))
      await node.request('run', {
        region: 'a', timeout_ticks: 400, programs: { sally: roam, anne: 'await goToPosition(bot, new Vec3(-7, -51, -7)); await think(bot, "here")' }
      })
      assert.ok(JSON.stringify(node.frames).includes('chat'))
      frames.push(node.frames)
      await node.close()
    }
    assert.ok(frames[0].length > 10)
    assert.deepEqual(frames[0], frames[1])
  })

  it('has the state ready in which programs of bots begin', () => {
    const { guest } = decode(gunzipSync(fs.readFileSync(path.join(folder, 'sandbox.msgpack.gz'))))
    const { Vec3, goals, mcData, ...skills } = scopeOf({ registry: {} }, () => {})
    const scope = JSON.parse(guest.scope)
    assert.deepEqual([scope.skills, scope.data], [Object.keys(skills), mcData !== undefined])
  })

  it('is small, and names what it is made of', () => {
    const files = fs.readdirSync(folder)
    const size = files.reduce((sum, file) => sum + fs.statSync(path.join(folder, file)).size, 0)
    assert.ok(size < LIMIT_BYTES, `${size} bytes`)
    const packages = JSON.parse(fs.readFileSync(path.join(folder, 'packages.json')))
    assert.ok(['mineflayer', 'flying-squid', 'minecraft-data'].every(name => packages[name].license === 'MIT'))
    const licenses = fs.readFileSync(path.join(folder, 'licenses.txt'), 'utf8')
    for (const name of Object.keys(packages)) assert.ok(licenses.includes(`== ${name} `), name)
  })
})
