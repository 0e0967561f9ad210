'use strict'

const { keyOf, vecOf } = require('./lib/positions')
const { opposite, vectorOf } = require('./lib/directions')
const { COLOURS } = require('./lib/smelting')

const METADATA_POSE = 6
const METADATA_BED = 14
const STANDING = 0
const SLEEPING = 2
const STOP_SLEEPING = 2
const LEAVE_BED = 2

/** Add beds: lying down and getting up. Sleep is not tied to night, because it is always noon here. */
module.exports.server = (serv) => {
  function partner (position, { properties }) {
    const toHead = properties.part === 'foot' ? properties.facing : opposite(properties.facing)
    return position.plus(vectorOf(toHead))
  }

  function occupy (position, occupied, player) {
    for (const part of [position, partner(position, serv.blocks.at(position))]) {
      const block = serv.blocks.at(part)
      if (block.name.endsWith('_bed')) serv.blocks.set(part, serv.blocks.stateWith(block, { occupied }), player)
    }
  }

  function lieDown ({ player, position, block }) {
    if (block.properties.occupied || player.bed) return true
    player.bed = vecOf(position)
    occupy(position, true, player)
    player.showPose(SLEEPING, player.bed)
    return true
  }
  COLOURS.forEach((colour) => serv.onInteraction(`${colour}_bed`, lieDown))

  serv.getUp = (player) => {
    const { bed } = player
    if (!bed) return
    player.bed = null
    if (serv.blocks.at(bed).name.endsWith('_bed')) occupy(bed, false, player)
    player.showPose(STANDING, null)
    serv._writeAll('animation', { entityId: player.id, animation: LEAVE_BED })
  }

  serv.blocks.on('update', ({ position, before, after, player }) => {
    const old = serv.blocks.describe(before)
    if (!old.name.endsWith('_bed') || serv.blocks.describe(after).name === old.name) return
    for (const sleeper of serv.players) if (sleeper.bed && keyOf(sleeper.bed) === keyOf(position)) serv.getUp(sleeper)
    const other = partner(position, old)
    if (serv.blocks.at(other).name === old.name) serv.blocks.set(other, 0, player)
  })
}

module.exports.player = (player, serv) => {
  player.bed = null
  player.showPose = (pose, bed) => serv._writeAll('entity_metadata', {
    entityId: player.id,
    metadata: [
      { key: METADATA_POSE, type: 'pose', value: pose },
      { key: METADATA_BED, type: 'optional_block_pos', value: bed ?? undefined },
    ],
  })
  player._client.on('entity_action', ({ actionId }) => {
    if (actionId === STOP_SLEEPING || actionId === 'stop_sleeping') serv.getUp(player)
  })
  for (const end of ['rest', 'disconnected']) player.on(end, () => serv.getUp(player))
}
