'use strict'
/**
 * Joining and leaving of players. A player joins at an exact position and at once: no search for a spawn point, no
 * announcement in the chat, no player file on disk.
 */
const NOON = 6000

module.exports.name = 'login'

module.exports.server = serv => {
  /**
   * Let a player join the active region.
   * @param {import('events').EventEmitter} end the server's end of its connection
   * @param {object} start `{position: Vec3 (server), yaw, pitch, onGround, health, food}`
   * @returns {object} the player
   */
  serv.join = (end, start) => {
    const type = serv.registry.entitiesByName.player.id
    serv.entityMaxId = freeNumber(serv) - 1
    const player = serv.initEntity('player', type, serv.overworld, start.position.clone())
    Object.assign(player, {
      _client: end,
      region: serv.region,
      agent: end.username,
      username: end.username,
      uuid: end.uuid,
      gameMode: 0,
      health: start.health,
      food: start.food,
      foodSaturation: 5,
      profileProperties: []
    })
    for (const plugin of serv.pluginList) plugin.player?.(player, serv, serv.options)
    player.pose = { yaw: start.yaw, pitch: start.pitch }
    player.onGround = start.onGround
    end.on('end', () => leave(player, serv))
    introduce(player, serv)
    return player
  }
}

module.exports.player = (player, serv) => {
  /** Send everything that a client needs in order to be in the world. */
  player.sendWorld = columns => {
    player._client.write('login', loginPacket(serv, player.id, player.gameMode))
    player.sendColumns(columns)
    player.sendSigns()
    player._client.write('spawn_position', { location: serv.region.spawnPoint, angle: 0 })
    player._client.write('update_time', { age: [0, 0], time: [0, NOON] })
    player._client.write('held_item_slot', { slot: player.heldItemSlot })
    player.sendSelfPosition()
  }
  player.kick = reason => player._client.end(reason)
}

// Return the lowest free entity number. It must not depend on players that left or items that were dropped before.
function freeNumber ({ entities }) {
  let number = 1
  while (number in entities) number += 1
  return number
}

/** Export the function that makes the packet `login`, which lets a client into the world. */
module.exports.loginPacket = loginPacket

function loginPacket (serv, entityId, gameMode) {
  const { dimensionCodec, ...packet } = serv.registry.loginPacket
  return {
    ...packet,
    entityId,
    gameMode,
    previousGameMode: -1,
    worldNames: Object.values(serv.dimensionNames),
    worldName: serv.dimensionNames[0],
    hashedSeed: serv.hashedSeed,
    maxPlayers: 255,
    viewDistance: 32,
    isFlat: true
  }
}

// Send the tab list first: clients ignore the entity of a player that is not in it.
function introduce (player, serv) {
  const entry = someone => ({
    uuid: someone.uuid,
    player: { name: someone.username, properties: someone.profileProperties },
    gamemode: someone.gameMode,
    listed: true,
    latency: 0
  })
  const action = { add_player: true, update_game_mode: true, update_listed: true, update_latency: true }
  const others = [...serv.players]
  serv.players.push(player)
  serv.uuidToPlayer[player.uuid] = player
  serv._writeArray('player_info', { action, data: [entry(player)] }, others)
  player.meet = () => {
    player._client.write('player_info', { action, data: serv.players.map(entry) })
    player.listed = true
    player.updateAndSpawn()
  }
}

function leave (player, serv) {
  serv.players.splice(serv.players.indexOf(player), 1)
  delete serv.uuidToPlayer[player.uuid]
  delete serv.entities[player.id]
  serv._writeAll('player_remove', { players: [player.uuid] })
  serv._writeAll('entity_destroy', { entityIds: [player.id] })
  player.emit('disconnected')
}
