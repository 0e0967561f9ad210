'use strict'
/** Translation of packets between the server's world and a region's scenario coordinates. */
const { toStep } = require('../steps')
const { TO_CLIENT, TO_SERVER } = require('./packets')

// The later statuses of block_dig (drop, release, swap) carry a meaningless location of zeros.
const LAST_DIG_STATUS_WITH_PLACE = 2
const FIXED_POINT = 8
const CHUNK_WIDTH = 16

/** Change of coordinates: whole chunks along x and z, and a renaming of players. */
class Shift {
  constructor (dx, dz, rename) {
    this.dx = dx
    this.dz = dz
    this.rename = rename
  }

  coordinates (place, scale, round) {
    const moved = { ...place }
    moved.x = round(place.x) + this.dx * scale
    moved.z = round(place.z) + this.dz * scale
    if (place.y !== undefined) moved.y = round(place.y)
    return moved
  }

  chunk (place, x, z) {
    return {
      ...place,
      [x]: place[x] + this.dx / CHUNK_WIDTH,
      [z]: place[z] + this.dz / CHUNK_WIDTH
    }
  }

  text (value) {
    if (typeof value === 'string') return this.rename(value)
    if (Array.isArray(value)) return value.map(entry => this.text(entry))
    if (value === null || typeof value !== 'object') return value
    return Object.fromEntries(Object.entries(value).map(([key, entry]) => [key, this.text(entry)]))
  }
}

const same = value => value

/** Function of each kind in packets.js: (shift, value, entry, packet) -> new value. */
const KINDS = {
  point: (shift, place) => shift.coordinates(place, 1, toStep),
  block: (shift, place) => shift.coordinates(place, 1, same),
  flat: (shift, place) => shift.coordinates(place, 1, same),
  fixed: (shift, place) => shift.coordinates(place, FIXED_POINT, same),
  absolute: (shift, packet) => shiftAbsolute(shift, packet),
  chunk: (shift, place, entry) => shift.chunk(place, entry.x, entry.z),
  chunks: (shift, list) => list.map(item => ({ ...item, position: shift.chunk(item.position, 'x', 'z') })),
  death: (shift, death) => ({ ...death, location: shift.coordinates(death.location, 1, same) }),
  dig: (shift, packet) => packet.status > LAST_DIG_STATUS_WITH_PLACE
    ? packet
    : { ...packet, location: shift.coordinates(packet.location, 1, same) },
  players: (shift, list) => list.map(item => item.player === undefined
    ? item
    : { ...item, player: { ...item.player, name: shift.rename(item.player.name) } }),
  text: (shift, component) => shift.text(component),
  words: (shift, words) => words.split(' ').map(word => shift.rename(word)).join(' ')
}

// Shift only absolute coordinates; the flags of a teleport say which are relative distances.
function shiftAbsolute (shift, packet) {
  const moved = shift.coordinates(packet, 1, toStep)
  // Since 1.21.2 flags are named fields.
  const isFar = (bit, name) => typeof packet.flags === 'object' ? packet.flags[name] : packet.flags & bit
  if (isFar(1, 'x')) moved.x = packet.x
  if (isFar(4, 'z')) moved.z = packet.z
  return moved
}

function apply (shift, entries, packet) {
  let result = packet
  for (const entry of entries) {
    const change = KINDS[entry.kind]
    if (entry.field === undefined) {
      result = change(shift, result, entry)
    } else if (result[entry.field] !== undefined && result[entry.field] !== null) {
      result = { ...result, [entry.field]: change(shift, result[entry.field], entry) }
    }
  }
  return result
}

class Translator {
  /**
   * @param {{x: number, z: number}} origin server position of scenario (0, y, 0); multiples of 16
   * @param {Map<string, string>} [agentOf] agent's name by the server's name of the player
   */
  constructor (origin, agentOf = new Map()) {
    const nameOf = new Map([...agentOf].map(([server, agent]) => [agent, server]))
    this.clientward = new Shift(-origin.x, -origin.z, renamer(agentOf))
    this.serverward = new Shift(origin.x, origin.z, renamer(nameOf))
  }

  /** Return a translated copy of a packet for the bot. @returns {object} */
  toClient (name, packet) {
    const entries = TO_CLIENT[name]
    return entries === undefined ? { ...packet } : apply(this.clientward, entries, packet)
  }

  /** Return a translated copy of a packet for the server. @returns {object} */
  toServer (name, packet) {
    const entries = TO_SERVER[name]
    return entries === undefined ? { ...packet } : apply(this.serverward, entries, packet)
  }
}

function renamer (names) {
  if (names.size === 0) return same
  const escaped = [...names.keys()].sort((a, b) => b.length - a.length)
    .map(name => name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&'))
  const pattern = new RegExp(`(?<![A-Za-z0-9_])(?:${escaped.join('|')})(?![A-Za-z0-9_])`, 'g')
  return text => text.replace(pattern, name => names.get(name))
}

module.exports = { Translator }
