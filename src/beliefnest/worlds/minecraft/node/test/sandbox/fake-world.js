'use strict'
/** Fake bot and skills: enough of the game to see what crosses the border. */

const { EventEmitter } = require('node:events')
const { Vec3 } = require('vec3')

const STATES = {
  1: { type: 1, name: 'stone', hardness: 1.5, properties: {} },
  9: { type: 8, name: 'lever', hardness: 0.5, properties: { powered: false } }
}

class FakeBlock {
  constructor (stateId, position) {
    const { type, name, hardness } = STATES[stateId]
    Object.assign(this, { stateId, type, name, hardness, displayName: name, metadata: 0, diggable: true, boundingBox: 'block', position, light: 0, skyLight: 15, secret: process })
  }

  getProperties () {
    return STATES[this.stateId].properties
  }
}

class FakeItem {
  constructor (type, name, count, slot) {
    Object.assign(this, { type, name, count, slot, metadata: 0, displayName: name, stackSize: 64, nbt: null })
  }
}

class FakeEntity {
  constructor (id, position, fields) {
    Object.assign(this, { id, position, velocity: new Vec3(0, 0, 0), yaw: 0, pitch: 0, height: 1.8, type: 'player', ...fields })
  }
}

class FakeWindow extends EventEmitter {
  constructor (items) {
    super()
    this.slots = [null, ...items]
    this.closed = false
  }

  items () { return this.slots.filter(Boolean) }
  emptySlotCount () { return 3 }
  close () { this.closed = true }
}

/** Return a bot whose `calls` lists the calls that it received. @returns {object} */
function fakeBot (username = 'sally') {
  const calls = []
  const note = (name) => (...args) => { calls.push([name, ...args]) }
  const bot = Object.assign(new EventEmitter(), {
    calls,
    username,
    version: '1.20.4',
    health: 20,
    food: 20,
    entity: new FakeEntity(1, new Vec3(1.5, 2, 3.5), { username }),
    inventory: new FakeWindow([new FakeItem(7, 'diamond', 3, 1)]),
    currentWindow: null,
    pathfinder: { goto: async (goal) => { calls.push(['goto', goal]) }, setGoal: note('setGoal'), thinkTimeout: 5000 },
    _client: { write: note('write'), end: note('end') },
    quit: note('quit'),
    end: note('end'),
    loadPlugin: note('loadPlugin'),
    chat: note('chat'),
    whisper: note('whisper'),
    setControlState: note('setControlState'),
    blockAt: (position) => position.y < 0 ? null : new FakeBlock(position.x === 9 ? 9 : 1, position.floored()),
    findBlocks: ({ matching, count }) => [0, 9].map((x) => new Vec3(x, 0, 0))
      .filter((position) => matching(Object.assign(bot.blockAt(position), { position: null }))).slice(0, count),
    dig: async (block) => { calls.push(['dig', block]) },
    openContainer: async () => new FakeWindow([new FakeItem(8, 'emerald', 2, 1)]),
    waitForTicks: (ticks) => new Promise((resolve) => { setTimeout(resolve, ticks) }),
    recipesFor: () => [{ result: { id: 7, count: 1 }, delta: [{ id: 5, count: -2 }], ingredients: null, inShape: null, requiresTable: false }],
    craft: async (recipe, count) => { calls.push(['craft', recipe, count]) }
  })
  bot.entities = { 1: bot.entity, 2: new FakeEntity(2, new Vec3(4, 2, 4), { username: 'anne' }) }
  bot.players = { sally: { username, entity: bot.entity, ping: 0 }, anne: { username: 'anne', entity: bot.entities[2], ping: 0 } }
  return bot
}

/** Return skills and data, as the scope of a program. @returns {object} */
function fakeScope (bot) {
  return {
    async goToPosition (own, position, dist = 2) {
      if (own !== bot) throw new Error('not my bot')
      if (position.y > 100) throw new Error(`cannot reach ${position}: got within ${dist}`)
      bot.calls.push(['goToPosition', position, dist])
      return position.offset(0, 1, 0)
    },
    async exploreUntil (own, direction, maxDistance, callback) {
      for (let step = 1; step <= maxDistance; step++) {
        const result = await callback(step)
        if (result) return result
      }
      return null
    },
    async echo (own, value) { return value },
    async never () { return new Promise(() => {}) },
    mcData: {
      blocksByName: { stone: { id: 1, name: 'stone', hardness: 1.5 }, lever: { id: 8, name: 'lever' } },
      itemsByName: { diamond: { id: 7, name: 'diamond', stackSize: 64 } },
      version: { minecraftVersion: '1.20.4', isNewer: () => true }
    }
  }
}

module.exports = { fakeBot, fakeScope, FakeBlock }
