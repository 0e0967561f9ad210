'use strict'
/** Vanilla commands that an operator types. Positions are scenario coordinates, angles those of the channel. */
const { toDegrees } = require('../server/angles')

/** Commands that an operator needs to set up a place. */
const NEEDED = ['fill', 'setblock', 'tp', 'item', 'clear', 'forceload', 'gamemode', 'kill']
/** Optional commands, each with the limitation that applies without it. */
const USEFUL = {
  effect: 'health and hunger are not restored',
  summon: 'no items can lie in the box at the start',
  data: 'signs cannot be written on at the start, and the inventories of people are not updated',
  kick: 'people who are connected cannot be taken over'
}

const SLOTS = { 5: 'armor.head', 6: 'armor.chest', 7: 'armor.legs', 8: 'armor.feet', 45: 'weapon.offhand' }
const FIRST_OWN = 9
const FIRST_HOTBAR = 36

/** Return the game's name of an inventory slot. @returns {string} */
function slotName (slot) {
  if (slot in SLOTS) return SLOTS[slot]
  return slot >= FIRST_HOTBAR ? `hotbar.${slot - FIRST_HOTBAR}` : `inventory.${slot - FIRST_OWN}`
}

/** Return a text in the game's own notation. */
const quoted = text => `'${text.replace(/[\\']/g, mark => `\\${mark}`)}'`

/**
 * Return the functions that build commands for a place.
 * @param {import('../regions/place').Place} place
 * @param {(state: number) => string} textOf returns the text of a block state
 * @param {object} version version of the server, from its registry: the notation of items and texts depends on it
 */
function commandsFor (place, textOf, version) {
  const countOf = count => version['>=']('1.20.5') ? `count:${count}` : `Count:${count}b`
  const component = text => quoted(version['>=']('1.21.5') ? text : JSON.stringify(text))
  const at = position => {
    const { x, y, z } = place.toServer(position)
    return `${x} ${y} ${z}`
  }
  const stack = item => item === null ? 'minecraft:air' : `minecraft:${item.name} ${item.count}`
  return {
    blocks: ({ state, low, high }) => low.every((value, axis) => value === high[axis])
      ? `setblock ${at(low)} minecraft:${textOf(state)}`
      : `fill ${at(low)} ${at(high)} minecraft:${textOf(state)}`,
    contents: (position, slot, item) => `item replace block ${at(position)} container.${slot} with ${stack(item)}`,
    wear: (agent, slot, item) => `item replace entity ${agent} ${slotName(slot)} with ${stack(item)}`,
    sendAway: agent => `kick ${agent} ${agent} is played by BeliefNest from now on`,
    clear: agent => `clear ${agent}`,
    mode: (player, mode) => `gamemode ${mode} ${player}`,
    go (player, position, pose) {
      const { yaw, pitch } = toDegrees(pose)
      return `tp ${player} ${at(position)} ${yaw} ${pitch}`
    },
    heal: agent => `effect give ${agent} minecraft:instant_health 1 5`,
    feed: agent => `effect give ${agent} minecraft:saturation 1 20`,
    dataOf: player => `data get entity ${player}`,
    dataAt: position => `data get block ${at(position)}`,
    removeItems () {
      const { low, shape } = place.box
      const { x, y, z } = place.toServer(low)
      return `kill @e[type=item,x=${x},y=${y},z=${z},dx=${shape[0] - 1},dy=${shape[1] - 1},dz=${shape[2] - 1}]`
    },
    layItem: ({ name, count, position }) =>
      `summon minecraft:item ${at(position)} {Item:{id:"minecraft:${name}",${countOf(count)}},PickupDelay:0}`,
    write: (position, line, text) => `data modify block ${at(position)} front_text.messages[${line}] set value ${component(text)}`,
    load (act) {
      const { low, high } = place.box
      const corner = ([x, , z]) => `${x + place.origin.x} ${z + place.origin.z}`
      return `forceload ${act} ${corner(low)} ${corner(high)}`
    }
  }
}

module.exports = { commandsFor, NEEDED, USEFUL }
