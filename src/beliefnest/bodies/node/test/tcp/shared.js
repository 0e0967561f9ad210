'use strict'
/** One server for all tests of this process, started with the first and ended after the last. */
const { after } = require('node:test')
const { Server, inWorld } = require('./world')

// Milliseconds each way: about what a server in the next country has.
const LATENCY = Number(process.env.BELIEFNEST_TCP_LATENCY ?? 30)

const server = new Server(LATENCY)
after(() => server.close())

module.exports = { inWorld: (setting, body) => inWorld(server, setting, body) }
