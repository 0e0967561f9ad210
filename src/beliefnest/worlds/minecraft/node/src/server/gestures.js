'use strict'
/** Visible gestures of a player's body: swinging arms, sprinting, sneaking. */

const MAIN_ARM = 0
// Index of an entity's flags in its metadata; flag 2 is sneaking, flag 8 sprinting.
const FLAGS = 0
const STANDING = 0x00
// Bots send the action as a number, the game's own clients as a name.
const SHOWN = new Map([
  [0, 0x02], ['start_sneaking', 0x02],
  [1, STANDING], ['stop_sneaking', STANDING],
  [3, 0x08], ['start_sprinting', 0x08],
  [4, STANDING], ['stop_sprinting', STANDING]
])

module.exports.name = 'animations'

module.exports.player = player => {
  player._client.on('arm_animation', () => {
    player.behavior('punch', {}, () => player._writeOthersNearby('animation', { entityId: player.id, animation: MAIN_ARM }))
  })
  player._client.on('entity_action', ({ actionId }) => {
    const flags = SHOWN.get(actionId)
    // Give the type by name: a type by number would be dropped from packets over TCP.
    if (flags !== undefined) player.setAndUpdateMetadata([{ key: FLAGS, type: 'byte', value: flags }])
  })
}
