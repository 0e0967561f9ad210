'use strict'
/** Versions of this build. */
module.exports = {
  minecraft: '1.20.4',
  mineflayer: require('mineflayer/package.json').version,
  flying_squid: require('flying-squid/package.json').version
}
