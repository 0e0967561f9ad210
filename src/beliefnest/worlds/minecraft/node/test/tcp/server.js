'use strict'
/**
 * Minecraft server of the project's own plugins, as a process of its own. It listens on a TCP port of this machine in
 * offline mode, speaks the whole protocol, and ticks in real time. Its parent process makes and inspects places over
 * the IPC channel: {id, op, ...} is answered by {id, result} or {id, error}. The server ends with that channel.
 *
 * `node server.js LATENCY`: milliseconds that every byte takes each way.
 */
require('../../src/prepare').prepare()
const { once } = require('node:events')
const minecraft = require('minecraft-protocol')
const { rememberBlocks } = require('../../src/blocks')
const { createServer } = require('../../src/server')
const versions = require('../../src/versions')
const { everything } = require('../plugins/everything')
const { Places, TICK_MS } = require('./places')
const { openDelayed } = require('./delay')
const { operations } = require('./operations')

async function main (latency) {
  const registry = require('prismarine-registry')(versions.minecraft)
  registry.loadDimensionCodec(registry.loginPacket.dimensionCodec)
  rememberBlocks(registry)
  const serv = createServer(registry)
  const places = new Places(serv)
  const listening = minecraft.createServer({
    host: '127.0.0.1', port: 0, version: versions.minecraft, 'online-mode': false, maxPlayers: 1000, motd: 'BeliefNest', hideErrors: true
  })
  listening.on('playerJoin', client => places.join(client))
  await once(listening, 'listening')
  const inner = listening.socketServer.address().port
  const port = latency > 0 ? await openDelayed(inner, latency) : inner
  keepTime(places)
  serve(operations(places, everything))
  process.send({ port })
}

/** Run twenty ticks a second; late ticks are made up for. */
function keepTime (places) {
  const start = performance.now()
  let ticks = 0
  setInterval(() => {
    for (; ticks * TICK_MS < performance.now() - start; ticks++) places.tick()
  }, TICK_MS / 2)
}

function serve (operations) {
  process.on('message', async ({ id, op, ...args }) => {
    try {
      process.send({ id, result: await operations[op](args) })
    } catch (error) {
      process.send({ id, error: error.stack })
    }
  })
  process.on('disconnect', () => process.exit(0))
}

main(Number(process.argv[2] ?? 0))
