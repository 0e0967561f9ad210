'use strict'
/**
 * Table of the positions and names in Minecraft 1.20.4's play packets. The translation between the server's world and
 * a region's own coordinates uses only this table. Relative positions (rel_entity_move, offsets of an explosion, block
 * entities of a chunk) are the same on both sides and are not listed.
 *
 * An entry applies to the packet itself, or to the object in its `field` if that is present. Its kind is one of:
 *
 * - `point`: x, y, z as fractions, which are rounded (steps.js); `block` and `flat`: x, y, z or x, z, kept exactly
 * - `fixed`: x, y, z in eighths of a block
 * - `absolute`: a point whose flags say which coordinates are relative
 * - `dig`: the location of block_dig, which is meaningless for some statuses
 * - `death`: the location of the last death
 * - `chunk`: chunk numbers under the two names given; `chunks`: a list of objects with a chunk's `position`
 * - `players`: a list of objects with a player's name
 * - `text`: a chat component; `words`: a command whose words may be names
 */
const point = { kind: 'point' }
const block = { kind: 'block', field: 'location' }
const chunk = (x, z, field) => ({ kind: 'chunk', x, z, field })

const TO_CLIENT = {
  spawn_entity: [point],
  sync_entity_position: [point],
  spawn_entity_experience_orb: [point],
  block_break_animation: [block],
  tile_entity_data: [block],
  block_action: [block],
  block_change: [block],
  face_player: [point],
  multi_block_change: [chunk('x', 'z', 'chunkCoordinates')],
  explosion: [point, { kind: 'point', field: 'center' }],
  unload_chunk: [chunk('chunkX', 'chunkZ')],
  map_chunk: [chunk('x', 'z')],
  world_event: [block],
  world_particles: [point],
  update_light: [chunk('chunkX', 'chunkZ')],
  login: [{ kind: 'death', field: 'death' }],
  respawn: [{ kind: 'death', field: 'death' }],
  vehicle_move: [point],
  open_sign_entity: [block],
  position: [{ kind: 'absolute' }],
  update_view_position: [chunk('chunkX', 'chunkZ')],
  spawn_position: [block],
  sound_effect: [{ kind: 'fixed' }],
  entity_teleport: [point],
  initialize_world_border: [{ kind: 'flat' }],
  world_border_center: [{ kind: 'flat' }],
  chunk_biomes: [{ kind: 'chunks', field: 'biomes' }],
  damage_event: [{ kind: 'point', field: 'sourcePosition' }],
  player_info: [{ kind: 'players', field: 'data' }],
  system_chat: [{ kind: 'text', field: 'content' }],
  profileless_chat: [{ kind: 'text', field: 'name' }, { kind: 'text', field: 'message' }]
}

const TO_SERVER = {
  query_block_nbt: [block],
  update_command_block: [block],
  update_structure_block: [block],
  generate_structure: [block],
  position: [point],
  position_look: [point],
  vehicle_move: [point],
  block_dig: [{ kind: 'dig' }],
  update_jigsaw_block: [block],
  update_sign: [block],
  block_place: [block],
  tab_complete: [{ kind: 'block', field: 'lookedAtBlock' }],
  chat_command_signed: [{ kind: 'words', field: 'command' }],
  chat_command: [{ kind: 'words', field: 'command' }]
}

module.exports = { TO_CLIENT, TO_SERVER }
