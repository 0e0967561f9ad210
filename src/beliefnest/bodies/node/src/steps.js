'use strict'
/**
 * Lengths are multiples of 2^-24 blocks wherever the server and a region's own coordinates
 * meet: such a number plus a whole offset is exact, so that what a region computes does not
 * depend on where in the world it lies.
 */
const STEPS = 2 ** 24

const toStep = value => Math.round(value * STEPS) / STEPS

module.exports = { toStep }
