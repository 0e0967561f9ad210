'use strict'
/** Base of both kinds of connection ends, in memory and over TCP. */
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
 * Hand a packet to the listeners at a server's end; they may be async.
 * @param {(error: Error) => void} report called with errors that a listener throws later
 */
function handOver (end, name, params, report) {
  for (const listener of end.listeners(name)) {
    const result = listener.call(end, params)
    if (result instanceof Promise) result.catch(report)
  }
}

module.exports = { End, handOver }
