'use strict'
/** Text of the vec3 package. A bundle contains it ready-made. */
const { readFileSync } = require('node:fs')

module.exports = { vec3Text: readFileSync(require.resolve('vec3'), 'utf8') }
