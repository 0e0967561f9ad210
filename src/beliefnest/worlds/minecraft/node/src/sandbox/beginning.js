'use strict'
/** State in which programs with the usual scope begin. A bundle has it ready-made; from source it is made on first use. */

/**
 * Return the state as `Engine.templateOf` makes it, and the scope as text; null: there is none.
 * @returns {?{scope: string, state: object, functions: Object<string, number>}}
 */
function readyMade () {
  return null
}

module.exports = { readyMade }
