'use strict'
/**
 * The embedded world in real time, with a port for people: driven as main.js is. It opens no connections; what it
 * listens on is what it was told.
 */
const { serve } = require('./channel/serving')
const { LiveHandler } = require('./live/liveHandler')

const [descriptor, lifeline] = process.argv.slice(2).map(Number)
require('./prepare').prepare()
serve((post, beat, ask) => new LiveHandler(null, post, beat, ask), descriptor, lifeline, { atOnce: true })
