'use strict'
/**
 * Base plugins of the server: flying-squid's own plugins that can be used as they are, and replacements for those that
 * read disks, print, or assume one place for everybody.
 */
module.exports = [
  require('./communication'),
  require('./world'),
  named('behavior', require('flying-squid/src/lib/plugins/behavior')),
  named('players', require('flying-squid/src/lib/plugins/players')),
  named('spawn', require('flying-squid/src/lib/plugins/spawn')),
  require('./movement'),
  named('health', require('flying-squid/src/lib/plugins/health')),
  require('./gestures'),
  named('sound', require('flying-squid/src/lib/plugins/sound')),
  named('particle', require('flying-squid/src/lib/plugins/particle')),
  require('./metadata'),
  require('./chat'),
  require('./login')
]

function named (name, plugin) {
  return { name, ...plugin }
}
