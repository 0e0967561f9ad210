'use strict'
/**
 * The Minecraft side of BeliefNest: one process with the server and all bots, driven over
 * one descriptor, ended by the end of that one or of the lifeline. With the arguments `containment PAIRS` it
 * measures its sandbox instead, and prints the times as JSON.
 */
const net = require('node:net')
const path = require('node:path')
const { Worker } = require('node:worker_threads')
const { Clock } = require('./time/clock')
const { installTime } = require('./time/install')

// build.js puts all programs side by side.
const LIFELINE_FILE = typeof BUNDLED === 'undefined' ? ['channel', 'lifeline.js'] : ['lifeline.js']

function main ([first, second]) {
  const clock = new Clock('')
  installTime(clock)
  require('./prepare').prepare()
  if (first === 'containment') measure(clock, Number(second)).catch(fail)
  else serve(clock, Number(first), Number(second))
}

/** @param {number} descriptor of the channel; the other one is of the lifeline */
function serve (clock, descriptor, lifeline) {
  const { Channel } = require('./channel/channel')
  const { RequestHandler } = require('./requestHandler')

  new Worker(path.join(__dirname, ...LIFELINE_FILE), { workerData: { descriptor: lifeline } })
    .on('error', fail)
  const stream = new net.Socket({ fd: descriptor, readable: true, writable: true })
  const handler = new RequestHandler(clock, message => channel.post(message), message => channel.beat(message))
  let turn = Promise.resolve()
  const channel = new Channel(stream, request => {
    turn = turn.then(() => answer(request)).catch(fail)
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

async function measure (clock, pairs) {
  const { measureContainment } = require('./containment')
  const times = await measureContainment(clock, pairs)
  process.stdout.write(JSON.stringify(times), () => process.exit(0))
}

// A promise nobody waits for was rejected, for instance by a program that has ended.
function note (error) {
  process.stderr.write(`unhandled rejection: ${error?.stack ?? error}\n`)
}

function fail (error) {
  process.stderr.write(`${error.stack}\n`)
  process.exit(1)
}

main(process.argv.slice(2))
