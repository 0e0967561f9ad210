'use strict'
/**
 * Commands of a vanilla server that an operator bot uses, in the game's own syntax, with absolute coordinates. Each is
 * `run(serv, words, player)`; it returns the server's answer, and throws a Refusal if the command is refused.
 */
const { Vec3 } = require('vec3')
const { fromDegrees, toDegrees } = require('../../src/server/angles')

const MOST_BLOCKS = 32768
const MODES = ['survival', 'creative', 'adventure', 'spectator']
const OWN_SLOTS = {
  'armor.head': 5, 'armor.chest': 6, 'armor.legs': 7, 'armor.feet': 8, 'weapon.offhand': 45
}

class Refusal extends Error {}

/** Return the state of a text such as `minecraft:lever[face=floor]`. @returns {number} */
function stateOf (serv, text) {
  const [, name, inner] = /^(?:minecraft:)?(\w+)(?:\[(.*)\])?$/.exec(text) ?? []
  if (serv.registry.blocksByName[name] === undefined) throw new Refusal(`Unknown block type '${text}'`)
  const properties = Object.fromEntries((inner ? inner.split(',') : []).map(each => each.split('=')))
  try {
    return serv.blocks.state(name, properties)
  } catch (error) {
    throw new Refusal(error.message)
  }
}

function stackOf (serv, text, count = '1') {
  const name = text.replace(/^minecraft:/, '')
  if (name === 'air') return null
  if (serv.registry.itemsByName[name] === undefined) throw new Refusal(`Unknown item '${text}'`)
  return new serv.Item(serv.registry.itemsByName[name].id, Number(count))
}

function playerOf (serv, name) {
  const player = serv.players.find(({ username }) => username === name)
  if (player === undefined) throw new Refusal('No player was found')
  return player
}

const place = words => new Vec3(...words.map(Number))

function requireLoaded (serv, position) {
  if (serv.overworld.sync.getColumn(position.x >> 4, position.z >> 4) === undefined) throw new Refusal('That position is not loaded')
}

function setblock (serv, [x, y, z, block]) {
  const position = place([x, y, z])
  requireLoaded(serv, position)
  if (serv.blocks.put(position, stateOf(serv, block)) === null) throw new Refusal('Could not set the block')
  return `Changed the block at ${x}, ${y}, ${z}`
}

function fill (serv, words) {
  const [from, to] = [place(words.slice(0, 3)), place(words.slice(3, 6))]
  const [low, high] = [from.min(to), from.max(to)]
  const size = high.minus(low).offset(1, 1, 1)
  const number = size.x * size.y * size.z
  if (number > MOST_BLOCKS) throw new Refusal(`Too many blocks in the specified area (maximum ${MOST_BLOCKS}, specified ${number})`)
  const state = stateOf(serv, words[6])
  let changed = 0
  for (let x = low.x; x <= high.x; x++) {
    for (let y = low.y; y <= high.y; y++) {
      for (let z = low.z; z <= high.z; z++) {
        requireLoaded(serv, { x, z })
        if (serv.blocks.put(new Vec3(x, y, z), state) !== null) changed += 1
      }
    }
  }
  if (changed === 0) throw new Refusal('No blocks were filled')
  return `Successfully filled ${changed} block(s)`
}

/** Run `NAME X Y Z YAW PITCH`, or `X Y Z` for the player itself. */
function tp (serv, words, self) {
  const [name, x, y, z, yaw, pitch] = words.length === 3 ? [self.username, ...words] : words
  const player = playerOf(serv, name)
  const angles = yaw === undefined ? player.pose : fromDegrees(Number(yaw), Number(pitch))
  player.place(place([x, y, z]), angles.yaw, angles.pitch)
  player.fallsFrom = null
  return `Teleported ${name} to ${x}, ${y}, ${z}`
}

/** Run `replace block X Y Z SLOT with ITEM COUNT` or `replace entity NAME SLOT with ITEM COUNT`. */
function item (serv, [, kind, ...words]) {
  if (kind === 'entity') {
    const [name, slot, , what, count] = words
    const player = playerOf(serv, name)
    player.inventory.slots[ownSlot(player, slot)] = stackOf(serv, what, count)
    player.inventoryChanged()
    return `Replaced a slot on ${name}`
  }
  const [x, y, z, slot, , what, count] = words
  const position = place([x, y, z])
  if (serv.containers.get(position) === null) throw new Refusal('Target position is not a container')
  serv.containers.slots(position)[Number(slot.split('.')[1])] = stackOf(serv, what, count)
  serv.containers.touch(position)
  return `Replaced a slot at ${x}, ${y}, ${z}`
}

function ownSlot (player, text) {
  if (text in OWN_SLOTS) return OWN_SLOTS[text]
  const [kind, number] = text.split('.')
  if (text === 'weapon.mainhand') return 36 + player.heldItemSlot
  return Number(number) + (kind === 'hotbar' ? 36 : 9)
}

function give (serv, [name, what, count]) {
  const player = playerOf(serv, name)
  player.storeItem(stackOf(serv, what, count))
  return `Gave ${count ?? 1} [${what}] to ${name}`
}

function clear (serv, [name]) {
  const player = playerOf(serv, name)
  if (player.inventory.slots.every(slot => !slot)) throw new Refusal(`No items were found on player ${name}`)
  player.inventory.slots.forEach((_, index) => { player.inventory.slots[index] = null })
  player.inventoryChanged()
  return `Removed the items of ${name}`
}

function gamemode (serv, [mode, name], self) {
  const player = name === undefined ? self : playerOf(serv, name)
  if (!MODES.includes(mode)) throw new Refusal(`Unknown game mode ${mode}`)
  player.gameMode = MODES.indexOf(mode)
  player._client.write('game_state_change', { reason: 3, gameMode: player.gameMode })
  return `Set ${player.username}'s game mode to ${mode}`
}

function effect (serv, [act, name, what, , amplifier]) {
  const player = playerOf(serv, name)
  if (act === 'clear') throw new Refusal('Target has no effects to remove')
  const kind = what.replace(/^minecraft:/, '')
  if (kind === 'instant_health') player.updateHealth(Math.min(20, player.health + (4 << Number(amplifier))))
  if (kind === 'saturation') player.updateFood(20)
  return `Applied effect ${kind} to ${name}`
}

/** Run the command for the only supported selector: dropped items in a box. */
function kill (serv, [selector]) {
  const [, conditions] = /^@e\[type=item,(.*)\]$/.exec(selector) ?? []
  if (conditions === undefined) throw new Refusal(`this server kills dropped items only, not ${selector}`)
  const limits = Object.fromEntries(conditions.split(',').map(each => each.split('=')).map(([key, value]) => [key, Number(value)]))
  const entities = serv.itemEntities(({ x, y, z }) => x >= limits.x && x <= limits.x + limits.dx + 1 &&
    y >= limits.y && y <= limits.y + limits.dy + 1 && z >= limits.z && z <= limits.z + limits.dz + 1)
  if (entities.length === 0) throw new Refusal('No entity was found')
  entities.forEach(({ id }) => serv.removeItem(id))
  return `Killed ${entities.length} entities`
}

function summon (serv, [what, x, y, z, tag]) {
  const [, name, count] = /id:"minecraft:(\w+)",Count:(\d+)b/.exec(tag) ?? []
  if (what !== 'minecraft:item' || name === undefined) throw new Refusal(`this server summons dropped items only, not ${what}`)
  serv.dropItem(place([x, y, z]), stackOf(serv, name, count), { delay: 0 })
  return 'Summoned new Item'
}

function forceload (serv, [act, ...corners]) {
  if (act === 'add') serv.loadColumns?.(...corners.map(Number))
  return act === 'add' ? 'Marked the chunks to be force loaded' : 'Unmarked the chunks'
}

/**
 * Run `get block X Y Z`, which returns contents in the game's notation, `get entity NAME`, or `modify block X Y Z
 * front_text.messages[N] set value '"TEXT"'`.
 */
function data (serv, [act, kind, x, y, z, ...words]) {
  if (kind === 'entity') return entityData(playerOf(serv, x))
  const position = place([x, y, z])
  if (act === 'modify') return write(serv, position, words)
  if (serv.containers.get(position) === null) throw new Refusal('The target block is not a block entity')
  const items = serv.containers.slots(position).flatMap((stack, slot) =>
    stack ? [`{Slot: ${slot}b, id: "minecraft:${stack.name}", Count: ${stack.count}b}`] : [])
  return `${x}, ${y}, ${z} has the following block data: {Items: [${items.join(', ')}]}`
}

function entityData (player) {
  const { position: { x, y, z }, pose, inventory, heldItemSlot, health, food } = player
  const { yaw, pitch } = toDegrees(pose)
  const items = inventory.slots.flatMap((stack, slot) => stack && numbers(slot) !== null
    ? [`{Slot: ${numbers(slot)}b, id: "minecraft:${stack.name}", Count: ${stack.count}b}`]
    : [])
  return `${player.username} has the following entity data: {Pos: [${x}d, ${y}d, ${z}d], Rotation: [${yaw}f, ${pitch}f], ` +
    `OnGround: ${Number(player.onGround)}b, Health: ${health}f, foodLevel: ${food}, SelectedItemSlot: ${heldItemSlot}, Inventory: [${items.join(', ')}]}`
}

/** Return the game's own number of an inventory slot; null for crafting slots. */
function numbers (slot) {
  if (slot === OWN_SLOTS['weapon.offhand']) return -106
  if (slot >= 36) return slot - 36
  if (slot >= 9) return slot
  return slot >= 5 ? 108 - slot : null
}

function write (serv, position, [path, , , ...words]) {
  const line = Number(/^front_text\.messages\[(\d)\]$/.exec(path)?.[1])
  const text = JSON.parse(words.join(' ').slice(1, -1).replace(/\\(.)/g, '$1'))
  const lines = serv.signs.get(position).split('\n')
  const changed = [0, 1, 2, 3].map(index => index === line ? text : lines[index] ?? '')
  serv.signs.set(position, changed.join('\n').replace(/\n+$/, ''))
  return 'Modified block data'
}

function gamerule (serv, [name, value]) {
  serv.gamerules ??= { doMobSpawning: 'true', doDaylightCycle: 'true', doWeatherCycle: 'true' }
  if (!(name in serv.gamerules)) throw new Refusal('Incorrect argument for command')
  if (value === undefined) return `Gamerule ${name} is currently set to: ${serv.gamerules[name]}`
  serv.gamerules[name] = value
  return `Gamerule ${name} is now set to: ${value}`
}

function kick (serv, [name, ...reason]) {
  playerOf(serv, name)._client.end(reason.join(' '))
  return `Kicked ${name}`
}

const COMMANDS = { clear, data, effect, fill, forceload, gamemode, gamerule, give, item, kick, kill, setblock, summon, tp }

/** Return the server's answer to a command. @returns {string} */
function runCommand (serv, text, player) {
  const [name, ...words] = text.split(' ')
  try {
    return COMMANDS[name](serv, words, player)
  } catch (error) {
    if (error instanceof Refusal) return error.message
    throw error
  }
}

module.exports = { COMMANDS, runCommand }
