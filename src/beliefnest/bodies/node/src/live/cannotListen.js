'use strict'

/** A port cannot be had; the message says which, and what to do. */
class CannotListen extends Error {
  constructor (host, port, { code, message }) {
    const why = { EADDRINUSE: 'another program listens there', EACCES: 'only the system may listen there', EADDRNOTAVAIL: 'this machine has no such address' }[code] ?? message
    super(`people cannot come in at ${host}:${port}: ${why}; give another port, or 0 for any that is free`)
  }

  /** Of the channel: the world failed, and the message is all there is to say. */
  get kind () { return 'world' }
}

module.exports = { CannotListen }
