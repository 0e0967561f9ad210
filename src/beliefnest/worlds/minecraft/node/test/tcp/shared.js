'use strict'
/** Server that all tests of this process share; it starts with the first test and ends after the last. */
const { after } = require('node:test')
const { Server, inWorld } = require('./world')

// Milliseconds each way: about that of a server in a neighbouring country.
const LATENCY = Number(process.env.BELIEFNEST_TCP_LATENCY ?? 30)

const server = new Server(LATENCY)
after(() => server.close())

module.exports = { inWorld: (setting, body) => inWorld(server, setting, body) }
