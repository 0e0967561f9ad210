'use strict'
/** Distance between two ends of a connection: every byte arrives, in order, some time later. */
const net = require('node:net')

/**
 * Open a port that leads to another one of this machine.
 * @param {number} target port
 * @param {number} milliseconds each way
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
  // Whoever breaks off tells the other side no more than that.
  from.on('error', () => to.destroy())
  from.on('close', () => later(() => to.destroy()))
}

module.exports = { openDelayed }
