'use strict'
/**
 * Program of the embedded world: one process with the server and all bots. It is driven over one descriptor, and ends
 * when that descriptor or the lifeline closes. With the arguments `containment PAIRS` it measures its sandbox instead
 * and prints the times as JSON.
 */
const { Clock } = require('./time/clock')
const { installTime } = require('./time/install')

function main ([first, second]) {
  const clock = new Clock('')
  installTime(clock)
  require('./prepare').prepare()
  if (first === 'containment') measure(clock, Number(second)).catch(fail)
  else start(clock, Number(first), Number(second))
}

function start (clock, descriptor, lifeline) {
  const { RequestHandler } = require('./requestHandler')
  const { serve } = require('./channel/serving')
  serve((post, beat, ask) => new RequestHandler(clock, post, beat, ask), descriptor, lifeline)
}

async function measure (clock, pairs) {
  const { measureContainment } = require('./containment')
  const times = await measureContainment(clock, pairs)
  process.stdout.write(JSON.stringify(times), () => process.exit(0))
}

function fail (error) {
  process.stderr.write(`${error.stack}\n`)
  process.exit(1)
}

main(process.argv.slice(2))
