'use strict'
/** What a player's body shows of itself: its arm swings, it sprints, it sneaks. */

const MAIN_ARM = 0
// Of an entity's metadata: its flags, of which 2 is sneaking and 8 is sprinting.
const FLAGS = 0
const STANDING = 0x00
// Bots say it by number, games by name.
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
    // The name of the type, as a number would be left out of what is sent over TCP.
    if (flags !== undefined) player.setAndUpdateMetadata([{ key: FLAGS, type: 'byte', value: flags }])
  })
}
