'use strict'
/** Packets that show an exhibit to a visiting client. The gallery assigns the entity ids. */
const { angleStep, toDegrees } = require('../server/angles')
const { agentUuid } = require('../bots/bot')
const { stacksOf } = require('../server/plugins/lib/items')
const { halvesAt } = require('../server/plugins/lib/doubleChest')
const { HALF, windowOf } = require('../server/plugins/lib/chestWindows')
const { keyOf } = require('../server/plugins/lib/positions')
const { signPacket } = require('../server/plugins/lib/signPacket')
const { slotsIn } = require('../remote/kinds')

const SURVIVAL = 0
const OWN_SLOTS = 36
/** Number of each equipment slot in the protocol. */
const PARTS = { main_hand: 0, off_hand: 1, feet: 2, legs: 3, chest: 4, head: 5 }
const LISTED = { add_player: true, update_game_mode: true, update_listed: true, update_latency: true }

/** Return the packet `player_info` that lists a player. @returns {object} */
function listing (name, { uuid = agentUuid(name), gamemode = SURVIVAL } = {}) {
  return { action: LISTED, data: [{ uuid, player: { name, properties: [] }, gamemode, listed: true, latency: 0 }] }
}

function turned (pose) {
  const { yaw, pitch } = toDegrees(pose)
  return { yaw: angleStep(yaw), pitch: angleStep(pitch) }
}

/** Return the packets that spawn an agent. */
function spawning (exhibit, label, pose, entityId, type) {
  const { x, y, z } = exhibit.toServer(pose.position)
  const { yaw, pitch } = turned(pose)
  return { entityId, objectUUID: agentUuid(label), type, x, y, z, yaw, pitch, headPitch: yaw, objectData: 0, velocity: { x: 0, y: 0, z: 0 } }
}

/** Return the packets that move an agent, in order. */
function moving (exhibit, pose, entityId) {
  const { x, y, z } = exhibit.toServer(pose.position)
  const { yaw, pitch } = turned(pose)
  return [
    ['entity_teleport', { entityId, x, y, z, yaw, pitch, onGround: pose.on_ground }],
    ['entity_head_rotation', { entityId, headYaw: yaw }]
  ]
}

/** Return the packet with an agent's armour and held items; empty slots are included. */
function wearing ({ equipment }, entityId, { Item, registry }) {
  const item = name => Item.toNotch(name === undefined ? null : new Item(registry.itemsByName[name].id, 1))
  return { entityId, equipments: Object.entries(PARTS).map(([part, slot]) => ({ slot, item: item(equipment[part]) })) }
}

function sign (exhibit, states, [x, y, z]) {
  const place = { x, y, z }
  return signPacket(exhibit.toServer([x, y, z]), states.describe(exhibit.at(place)).name, exhibit.signs.get(keyOf(place)) ?? '')
}

/**
 * Return the window of the container at a position.
 * @param {object} place position in the exhibit
 * @returns {{type: number, title: string, items: Array} | null} null if no container stands there
 */
function inside (exhibit, place, states, { Item, registry }) {
  const { name } = states.describe(exhibit.at(place))
  if (slotsIn(name) === 0) return null
  const halves = halvesAt(each => states.describe(exhibit.at(each)), place)
  const content = exhibit.containers.get(keyOf(halves[0])) ?? { items: {}, complete: false }
  const { type, title } = windowOf(name, halves.length)
  const stacks = stacksOf(Item, registry, content.items)
  const slots = Array.from({ length: halves.length * HALF }, (_, slot) => stacks[slot] ?? null)
  return { type, title: `${title}${completeness(content)}`, items: [...slots, ...new Array(OWN_SLOTS).fill(null)].map(stack => Item.toNotch(stack)) }
}

/**
 * Return the suffix of a window's title that says which contents are unknown: an empty window would mean that the
 * container is empty.
 */
function completeness ({ items, complete }) {
  if (complete) return ''
  return Object.keys(items).length === 0 ? ' (contents unknown)' : ' (known in part)'
}

module.exports = { inside, listing, moving, sign, spawning, wearing }
