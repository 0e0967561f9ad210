'use strict'
/**
 * Program for remote Minecraft servers: one process with an operator and all bots in real time, driven in the same way
 * as main.js. The embedded world's process opens no sockets and contains none of this code.
 */
require('./time/ownTime').installOwnTime()
const { serve } = require('./channel/serving')
const { RemoteHandler } = require('./remote/remoteHandler')

// The arguments before these two are folders with data of further Minecraft versions (bundling/further.js).
const [descriptor, lifeline] = process.argv.slice(-2).map(Number)
require('./prepare').prepare()
serve((post, beat, ask) => new RemoteHandler(null, post, beat, ask), descriptor, lifeline, { atOnce: true })
