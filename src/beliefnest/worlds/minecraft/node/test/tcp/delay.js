'use strict'
/** Delay between two ends of a connection: every byte arrives, in order, some time later. */
const net = require('node:net')

/**
 * Open a port that forwards to another port of this machine.
 * @param {number} target number of the other port
 * @param {number} milliseconds delay each way
 * @returns {Promise<number>} the port
 */
function openDelayed (target, milliseconds) {
  const server = net.createServer({ noDelay: true, allowHalfOpen: false }, near => {
    const far = net.connect({ port: target, host: '127.0.0.1', noDelay: true })
    carry(near, far, milliseconds)
    carry(far, near, milliseconds)
  })
  return new Promise((resolve, reject) => {
    server.on('error', reject)
    server.listen(0, '127.0.0.1', () => resolve(server.address().port))
  })
}

function carry (from, to, milliseconds) {
  const later = action => setTimeout(action, milliseconds)
  from.on('data', bytes => later(() => { if (to.writable) to.write(bytes) }))
  from.on('end', () => later(() => to.end()))
  // The other side learns only that the connection has ended.
  from.on('error', () => to.destroy())
  from.on('close', () => later(() => to.destroy()))
}

module.exports = { openDelayed }
