'use strict'
/** Capture of a place on a remote server: reads it and changes nothing. */
const { Box } = require('../regions/box')
const { rounded, sorted } = require('../regions/facts')
const { fromDegrees, wrap } = require('../server/angles')
const { byPlace, listOf, vecOf } = require('../server/plugins/lib/positions')
const { possessionsIn } = require('../places/held')
const { textOf } = require('../../../../../skills/code/lib/signs')
const { commandsFor } = require('./commands')
const { wornBy } = require('./person')
const { RemotePlace } = require('./remotePlace')
const { Scene } = require('./scene')
const { Setup } = require('./setup')
const { BlockMapping } = require('./versions')

const FULL = 20
const SPECTATOR = 3

/**
 * Read a place.
 * @param {object} session result of beginSession, and our `registry`
 * @param {{x: number, z: number}} origin server position of scenario (0, y, 0)
 * @param {number[][]} corners corners of the box, scenario coordinates
 * @param {{side: number, margin: number}} cut how its blocks are cut into cubes (Assembly)
 * @returns {Promise<object>} SNAPSHOT, with `unread`: [x, y, z] of containers that could not be opened, `unasked`:
 *   names of players of whom only visible equipment is known, and `strange`: names of blocks that our version lacks
 */
async function capture ({ operator, clock, theirs, registry }, origin, corners, cut) {
  const region = new RemotePlace({ name: 'captured', box: new Box(...corners), origin, tick: 0, agentNames: [] }, clock)
  const mapping = new BlockMapping(registry, theirs)
  const commands = commandsFor(region, state => mapping.textForServer(state), theirs.version)
  const scene = new Scene(region, mapping, operator, commands, position => setup.read(position))
  const setup = new Setup(scene, operator, commands, theirs)
  return operator.attended(async () => {
    await setup.arrive()
    try {
      return { ...await look(setup, commands, cut), strange: [...mapping.strange].sort() }
    } finally {
      operator.type(commands.load('remove'))
      await operator.settled()
    }
  })
}

/** Return all contents of the place of a set-up. @returns {Promise<object>} */
async function look (setup, commands, cut) {
  const { operator, scene, region } = setup
  const present = operator.readTerrain(region.box, cut, scene.mapping)
  scene.settle(present)
  const content = await contents(setup, present)
  await setup.goAbove()
  return {
    tick: 0, blocks: present.message(), items: {}, internal_state: new Uint8Array(0), signs: signs(operator.bot, scene, present), ...content, ...await players(operator, commands, region)
  }
}

async function contents (setup, terrain) {
  const [containers, unread] = [[], []]
  for (const position of setup.containers(terrain)) {
    const items = await setup.read(position)
    containers.push([...position, sorted(items ?? {})])
    if (items === null) unread.push(position)
  }
  return { containers: containers.sort(byPlace), unread }
}

function signs (bot, { states }, terrain) {
  const signs = []
  terrain.find(state => states.describe(state).name.endsWith('_sign'), (x, y, z) => {
    const text = textOf(bot.blockAt(vecOf({ x, y, z })))
    if (text !== '') signs.push([x, y, z, text])
  })
  return signs.sort(byPlace)
}

async function players (operator, commands, region) {
  const { bot } = operator
  const [agents, unasked] = [{}, []]
  for (const { username, entity, gamemode } of Object.values(bot.players)) {
    if (!entity || gamemode === SPECTATOR || !region.box.contains(...listOf(entity.position.floored()))) continue
    const data = operator.can('data') ? await operator.ask(commands.dataOf(username)) : null
    if (data === null) unasked.push(username)
    agents[username] = data === null ? { ...pose(entity), ...seen(entity) } : savedState(region, data)
  }
  return { agents: sorted(agents), unasked }
}

/** Return an agent from the server's own data of it. */
function savedState (region, data) {
  const [x, y, z] = data.Pos
  const { yaw, pitch } = fromDegrees(...data.Rotation)
  return {
    position: region.toScenario({ x, y, z }).map(rounded),
    yaw: rounded(yaw),
    pitch: rounded(pitch),
    on_ground: Boolean(data.OnGround),
    health: data.Health,
    food: data.foodLevel,
    ...possessionsIn(data, data.SelectedItemSlot ?? 0)
  }
}

function pose ({ position, yaw, headYaw, pitch, onGround }) {
  return {
    position: position.toArray().map(rounded), yaw: rounded(wrap(headYaw ?? yaw)), pitch: rounded(wrap(pitch)), on_ground: onGround, health: FULL, food: FULL
  }
}

/** Return the visible possessions of a player. */
function seen ({ equipment }) {
  const worn = wornBy({ equipment })
  const inventory = {}
  for (const name of Object.values(worn)) inventory[name] = (inventory[name] ?? 0) + 1
  return { equipment: worn, inventory }
}

module.exports = { capture }
