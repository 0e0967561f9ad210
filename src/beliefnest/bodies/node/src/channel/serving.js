'use strict'
/** A process that answers requests on one descriptor, one at a time, and ends with it or with its lifeline. */
const net = require('node:net')
const path = require('node:path')
const { Worker } = require('node:worker_threads')
const { Channel } = require('./channel')

// build.js puts it beside the programs, too.
const LIFELINE_FILE = 'lifeline.js'

/**
 * @param {(post: function(object): void, beat: function(object): void, ask: function(object): Promise<object>) => object} makeHandler
 *   gives who answers: `answer(request)`, `prepare()`, `note(message)` of what asks for no answer; `ask` sends a question and resolves with what the other side says to it
 * @param {number} descriptor of the channel
 * @param {number} lifeline another one
 * @param {object} [options]
 * @param {boolean} [options.atOnce] whether what is posted is sent at once, for those who look on in real time
 */
function serve (makeHandler, descriptor, lifeline, { atOnce = false } = {}) {
  new Worker(path.join(__dirname, LIFELINE_FILE), { workerData: { descriptor: lifeline } })
    .on('error', fail)
  const stream = new net.Socket({ fd: descriptor, readable: true, writable: true })
  let asking = null
  const ask = question => {
    asking = Promise.withResolvers()
    channel.send(question)
    return asking.promise
  }
  const handler = makeHandler(message => atOnce ? channel.send(message) : channel.post(message), message => channel.beat(message), ask)
  let turn = Promise.resolve()
  const channel = new Channel(stream, request => {
    // What answers a question is no request.
    if (request.op === undefined) asking.resolve(request)
    else if (request.id === undefined) handler.note(request)
    else turn = turn.then(() => answer(request)).catch(fail)
  })
  async function answer (request) {
    channel.send(await handler.answer(request))
    if (request.op === 'shutdown') stream.end(() => process.exit(0))
    else await handler.prepare()
  }
  stream.on('end', () => process.exit(0))
  stream.on('error', () => process.exit(1))
  process.on('unhandledRejection', note)
}

// A promise nobody waits for was rejected, for instance by a program that has ended.
function note (error) {
  process.stderr.write(`unhandled rejection: ${error?.stack ?? error}\n`)
}

function fail (error) {
  process.stderr.write(`${error.stack}\n`)
  process.exit(1)
}

module.exports = { serve }
