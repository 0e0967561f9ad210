'use strict'
/**
 * Rounding of lengths to multiples of 2^-24 blocks, wherever the server's and a region's own coordinates meet. The sum
 * of such a number and a whole offset is exact, so that results in a region do not depend on where in the world it
 * lies.
 */
const STEPS = 2 ** 24

const toStep = value => Math.round(value * STEPS) / STEPS

module.exports = { toStep }
