'use strict'

/** Error for a request that cannot be fulfilled. The request has changed nothing. */
class BadRequest extends Error {
  get kind () { return 'bad_request' }
}

module.exports = { BadRequest }
