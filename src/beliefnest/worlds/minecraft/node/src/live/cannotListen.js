'use strict'

/** Error for a port that cannot be opened. The message says which port, and what to do. */
class CannotListen extends Error {
  constructor (host, port, { code, message }) {
    const why = { EADDRINUSE: 'another program listens there', EACCES: 'only the system may listen there', EADDRNOTAVAIL: 'this machine has no such address' }[code] ?? message
    super(`people cannot come in at ${host}:${port}: ${why}; give another port, or 0 for any that is free`)
  }

  /** Kind of the failure for the channel: the world failed, and the message says everything. */
  get kind () { return 'world' }
}

module.exports = { CannotListen }
