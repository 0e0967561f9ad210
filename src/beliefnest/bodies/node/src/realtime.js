'use strict'
/**
 * The side of BeliefNest that plays on a Minecraft server elsewhere: one process with an operator and all bots in real
 * time, driven as main.js is. No part of it goes to the embedded world's process, which opens no sockets.
 */
const { serve } = require('./channel/serving')
const { RemoteHandler } = require('./remote/remoteHandler')

// Before them, folders with data of further Minecraft versions (bundling/further.js).
const [descriptor, lifeline] = process.argv.slice(-2).map(Number)
require('./prepare').prepare()
serve((post, beat, ask) => new RemoteHandler(null, post, beat, ask), descriptor, lifeline, { atOnce: true })
