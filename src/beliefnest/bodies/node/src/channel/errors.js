'use strict'

/** The caller asked for something that cannot be; nothing was changed. */
class BadRequest extends Error {
  get kind () { return 'bad_request' }
}

module.exports = { BadRequest }
