'use strict'

const { Vec3 } = require('vec3')

/** Block positions as keys of maps and as plain lists. */
const keyOf = ({ x, y, z }) => `${x},${y},${z}`
const listOf = ({ x, y, z }) => [x, y, z]
const vecOf = ({ x, y, z }) => new Vec3(x, y, z)
const centreOf = ({ x, y, z }) => new Vec3(x + 0.5, y + 0.5, z + 0.5)
/** Order of rows that begin with x, y, z. */
const byPlace = (a, b) => a[0] - b[0] || a[1] - b[1] || a[2] - b[2]

module.exports = { byPlace, keyOf, listOf, vecOf, centreOf }
