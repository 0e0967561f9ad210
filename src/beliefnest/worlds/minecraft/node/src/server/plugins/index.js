'use strict'
/**
 * Plugins for features that flying-squid lacks, one per file, in the order of their set-up. A plugin with the name of
 * one of flying-squid's replaces it.
 *
 * The owner of time calls `serv.tickRegion(within)` once per tick (see ticking.js).
 */
module.exports = [
  named('internalState', require('./internalState')),
  named('ticking', require('./ticking')),
  named('facts', require('./facts')),
  named('changes', require('./blocks')),
  named('spawning', require('./spawning')),
  named('placeBlock', require('./interact')),
  named('inventory', require('./inventories')),
  named('windows', require('./windows')),
  named('equipment', require('./equipment')),
  named('itemEntities', require('./itemEntities')),
  named('itemMotion', require('./itemMotion')),
  named('containers', require('./containers')),
  named('transfers', require('./transfers')),
  named('acts', require('./acts')),
  named('reports', require('./reports')),
  named('chests', require('./chests')),
  named('furnaces', require('./furnaces')),
  named('crafting', require('./crafting')),
  named('levers', require('./levers')),
  named('doors', require('./doors')),
  named('signs', require('./signs')),
  named('power', require('./power')),
  named('plates', require('./plates')),
  named('placement', require('./placement')),
  named('digging', require('./digging')),
  named('beds', require('./beds')),
  named('falling', require('./falling')),
  named('support', require('./support')),
  named('wellbeing', require('./wellbeing')),
]

function named (name, plugin) {
  return { name, ...plugin }
}
