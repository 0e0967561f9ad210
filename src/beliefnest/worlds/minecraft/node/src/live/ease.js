'use strict'

const NIGHT_VISION = 15
const FOR_EVER = -1

/** Send a client with a screen what it needs besides: the end of its loading screen, and light. */
function ease (end, entityId) {
  end.write('game_state_change', { reason: 'level_chunks_load_start', gameMode: 0 })
  end.write('entity_effect', { entityId, effectId: NIGHT_VISION, amplifier: 0, duration: FOR_EVER, hideParticles: 0 })
}

module.exports = { ease }
