'use strict'
/**
 * Program of the embedded world in real time, with a port for people. It is driven in the same way as main.js. It
 * opens no connections and listens only on the address it is given.
 */
require('./time/ownTime').installOwnTime()
const { serve } = require('./channel/serving')
const { LiveHandler } = require('./live/liveHandler')

const [descriptor, lifeline] = process.argv.slice(2).map(Number)
require('./prepare').prepare()
serve((post, beat, ask) => new LiveHandler(null, post, beat, ask), descriptor, lifeline, { atOnce: true })
