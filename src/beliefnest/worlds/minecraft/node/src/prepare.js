'use strict'
/** Preparation of a run from source. A bundle has these steps built in. */
const { memoiseInstalled } = require('./memoise')

function prepare () {
  memoiseInstalled()
}

module.exports = { prepare }
