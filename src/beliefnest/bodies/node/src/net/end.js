'use strict'
/** What both sorts of ends of a connection are, in memory and over TCP. */
const { EventEmitter } = require('node:events')

class End extends EventEmitter {
  /**
   * @param {string} username
   * @param {string} uuid
   */
  constructor (username, uuid) {
    super()
    this.setMaxListeners(0)
    this.username = username
    this.uuid = uuid
    this.latency = 0
  }
}

/**
 * Hand a packet to those who listen for it at a server's end; they may be async.
 * @param {(error: Error) => void} report hears what such a one throws later
 */
function handOver (end, name, params, report) {
  for (const listener of end.listeners(name)) {
    const result = listener.call(end, params)
    if (result instanceof Promise) result.catch(report)
  }
}

module.exports = { End, handOver }
