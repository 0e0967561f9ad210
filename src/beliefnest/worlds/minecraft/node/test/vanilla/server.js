'use strict'
/**
 * Minecraft server of the project's own plugins that reacts to an operator bot like a vanilla one, as a process of its
 * own: `node server.js [OPTIONS]`. OPTIONS is a JSON object: `port` (0: any), `ops`, `age`, `latency` (milliseconds
 * each way), `tickMs`, `version` of Minecraft, `diesAt` (number of the players' packet that ends the process),
 * `commandsLate` (ticks after which operators receive their own commands). It prints `{"port": N}` and then reads
 * lines on its standard input like a console (world.js); it ends with that input.
 */
require('../../src/prepare').prepare()
const { once } = require('node:events')
const readline = require('node:readline')
const minecraft = require('minecraft-protocol')
const { rememberBlocks } = require('../../src/blocks')
const { createServer } = require('../../src/server')
const versions = require('../../src/versions')
const { openDelayed } = require('../tcp/delay')
const { OpenWorld, TICK_MS } = require('./world')

const DEFAULTS = {
  port: 0, ops: ['BeliefNest'], age: 1000, latency: 0, tickMs: TICK_MS, version: versions.minecraft, diesAt: Infinity, commandsLate: 0
}

async function main (options) {
  const registry = require('prismarine-registry')(options.version)
  if (registry.version['<']('1.20.5')) registry.loadDimensionCodec(registry.loginPacket.dimensionCodec)
  rememberBlocks(registry)
  const serv = createServer(registry)
  if (!registry.supportFeature('chatPacketsUseNbtComponents')) serv._createNetworkEncodedChatComponent = text => JSON.stringify({ text })
  const world = new OpenWorld(serv, options)
  const listening = minecraft.createServer({
    host: '127.0.0.1', port: options.port, version: options.version, 'online-mode': false, maxPlayers: 100, motd: 'BeliefNest', hideErrors: true, beforeLogin: client => world.admit(client)
  })
  listening.onlineModeExceptions = world.verified
  listening.on('playerJoin', client => world.join(client))
  await once(listening, 'listening')
  const inner = listening.socketServer.address().port
  const port = options.latency > 0 ? await openDelayed(inner, options.latency) : inner
  keepTime(world, options.tickMs)
  const input = readline.createInterface({ input: process.stdin })
  input.on('line', line => world.console(line))
  input.on('close', () => process.exit(0))
  process.stdout.write(`${JSON.stringify({ port })}\n`)
}

/** Run as many ticks as fit into the time by the length of one; late ticks are made up for, up to two seconds. */
function keepTime (world, tickMs) {
  let due = performance.now()
  setInterval(() => {
    due = Math.max(due, performance.now() - 2000)
    for (; due < performance.now(); due += tickMs) world.tick()
  }, TICK_MS / 5)
}

main({ ...DEFAULTS, ...JSON.parse(process.argv[2] ?? '{}') })
