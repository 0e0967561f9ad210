'use strict'
/**
 * Rounding of lengths to multiples of 2^-24 blocks when coordinates are converted between the server and a region. The
 * sum of such a number and a whole offset is exact, so results in a region do not depend on its place in the world.
 */
const STEPS = 2 ** 24

const toStep = value => Math.round(value * STEPS) / STEPS

module.exports = { toStep }
