'use strict'
/** Source text that prepares a fresh QuickJS context for a program. */

const parts = [
  require('./primordials'), require('./vec3'), require('./values'), require('./border'), require('./globals'), require('./date'),
  require('./claims'), require('./main')
]

/**
 * Expression of a function of (host, now, random, configText), which prepares the global object and returns
 * `{bind(scopeText), start(program, marks), dispatch(text), describe(error)}`.
 */
const guestSource = `(function (host, now, random, configText) {
  'use strict'
  const env = { host, now, random, config: JSON.parse(configText) };
  ${parts.slice(0, -1).map((part) => `(${part})(env);`).join('\n')}
  return (${parts.at(-1)})(env)
})`

module.exports = { guestSource }
