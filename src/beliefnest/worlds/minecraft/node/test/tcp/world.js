'use strict'
/**
 * Worlds with real bots over TCP, in real time, on a server in another process (server.js). They have the interface of
 * the embedded worlds of ../skills/embedded.js.
 */
require('../../src/prepare').prepare()
const { fork } = require('node:child_process')
const { once } = require('node:events')
const path = require('node:path')
const { setTimeout: sleep } = require('node:timers/promises')
const { rememberBlocks } = require('../../src/blocks')
const { REAL_TIME, startBot } = require('../../src/bots/bot')
const versions = require('../../src/versions')
const { connect } = require('../../src/remote/connection')

const TICK_MS = 50
const LIMIT_MS = 180_000

class Server {
  /**
   * @param {number} latency milliseconds that every byte takes each way
   */
  constructor (latency) {
    this.child = fork(path.join(__dirname, 'server.js'), [String(latency)], { stdio: ['ignore', 'inherit', 'inherit', 'ipc'] })
    this.waiting = new Map()
    this.lastId = 0
    this.places = 0
    const fail = error => {
      for (const { reject } of this.waiting.values()) reject(error)
      this.waiting.clear()
    }
    this.child.on('exit', (code, signal) => fail(new Error(`the server ended with ${signal ?? `status ${code}`}`)))
    this.started = once(this.child, 'message').then(([{ port }]) => {
      this.child.on('message', message => this.receive(message))
      return port
    })
  }

  receive ({ id, result, error }) {
    const { resolve, reject } = this.waiting.get(id)
    this.waiting.delete(id)
    if (error === undefined) resolve(result)
    else reject(new Error(`the server says: ${error}`))
  }

  /** Return the answer of operations.js. @returns {Promise<any>} */
  ask (op, args) {
    return new Promise((resolve, reject) => {
      this.waiting.set(++this.lastId, { resolve, reject })
      this.child.send({ id: this.lastId, op, ...args })
    })
  }

  async close () {
    const ended = once(this.child, 'exit')
    this.child.disconnect()
    await ended
  }
}

/** Run `body(world)` in a place of its own; any number may run at the same time. */
async function inWorld (server, { agents, blocks, containers, box }, body) {
  const port = await server.started
  const registry = require('prismarine-registry')(versions.minecraft)
  rememberBlocks(registry)
  const place = `place${++server.places}`
  const players = Object.fromEntries(Object.keys(agents).map(agent => [agent, `p${server.places}_${agent}`]))
  const origin = await server.ask('create', { place, box, blocks, containers, agents, players })
  const agentOf = new Map(Object.entries(players).map(([agent, player]) => [player, agent]))
  const bots = {}
  const faults = []
  try {
    await Promise.all(Object.entries(players).map(async ([agent, username]) => {
      const bot = startBot(connect({ port, version: versions.minecraft, username, agent, origin, agentOf }), REAL_TIME)
      bots[agent] = bot
      bot.on('error', error => faults.push(error))
      await once(bot, 'spawn')
    }))
    const world = worldOf(server, place, bots)
    await world.ticks(1)
    await world.until(() => Object.values(bots).every(bot => bot.entity.onGround))
    await body(world)
    if (faults.length > 0) throw faults[0]
  } finally {
    // Packets that a bot sends while it is being disconnected reach nobody.
    const ended = Object.values(bots).map(bot => new Promise(resolve => { bot.once('end', resolve) }))
    await server.ask('destroy', { place })
    await Promise.all(ended)
  }
}

function whatItDoes ([name, bot]) {
  const moves = bot.pathfinder.isMoving() ? ', walking' : ''
  return `${name} is at ${bot.entity.position}${moves}, with ${bot.currentWindow?.type ?? 'no window'} open`
}

function worldOf (server, place, bots) {
  const ask = (op, args) => server.ask(op, { place, ...args })
  const ticks = number => ask('pass', { ticks: number })
  const look = async (op, args) => {
    await ticks(0)
    return ask(op, args)
  }
  const none = Symbol('none')
  return {
    bots,
    isVirtual: false,
    nextTick: () => sleep(TICK_MS),
    ticks,
    async until (condition) {
      const end = Date.now() + LIMIT_MS
      while (!await condition()) {
        if (Date.now() > end) throw new Error(`not within ${LIMIT_MS} ms: ${condition}`)
        await sleep(TICK_MS)
      }
    },
    async during (promise) {
      const ending = new AbortController()
      const late = sleep(LIMIT_MS, none, { signal: ending.signal }).catch(() => none)
      const result = await Promise.race([promise, late]).finally(() => ending.abort())
      if (result === none) throw new Error(`not within ${LIMIT_MS} ms; ${Object.entries(bots).map(whatItDoes).join('; ')}`)
      return result
    },
    async events (...kinds) {
      const events = await look('events')
      return events.filter(({ kind }) => kinds.length === 0 ? kind !== 'block_update' : kinds.includes(kind))
    },
    tick: () => ask('tick'),
    player: agent => look('agent', { agent }),
    has: async agent => (await look('agent', { agent })).inventory,
    container: (...position) => look('container', { position }),
    block: (...position) => look('block', { position }),
    countBlocks: names => look('blocks', { names }),
    everything: () => look('everything'),
    drop: (position, name, age = 0) => ask('drop', { position, name, age })
  }
}

module.exports = { Server, inWorld, REAL_TIME, TICK_MS }
