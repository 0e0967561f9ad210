'use strict'
/** Server process of one channel: it answers one request at a time, and ends with the channel or with its lifeline. */
const net = require('node:net')
const path = require('node:path')
const { Worker } = require('node:worker_threads')
const { Channel } = require('./channel')

// build.js puts the worker's file beside the programs, too.
const LIFELINE_FILE = 'lifeline.js'

/**
 * Answer the requests of a channel.
 * @param {(post: function(object): void, beat: function(object): void, ask: function(object): Promise<object>) =>
 *   object} makeHandler returns the handler: `answer(request)`, `prepare()`, and `note(message)` for messages without
 *   a reply; `ask` sends a question and resolves with the other side's reply
 * @param {number} descriptor descriptor of the channel
 * @param {number} lifeline descriptor of the lifeline
 * @param {object} [options]
 * @param {boolean} [options.atOnce] whether posted messages are sent immediately, for spectators in real time
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
    // A message without `op` is the reply to a question, not a request.
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

// Log a rejected promise that nobody awaits, for instance one of a program that has ended.
function note (error) {
  process.stderr.write(`unhandled rejection: ${error?.stack ?? error}\n`)
}

function fail (error) {
  process.stderr.write(`${error.stack}\n`)
  process.exit(1)
}

module.exports = { serve }
