'use strict'
/** What the bundle has built in and a run from source does when it starts. */
const { memoiseInstalled } = require('./memoise')

function prepare () {
  memoiseInstalled()
}

module.exports = { prepare }
