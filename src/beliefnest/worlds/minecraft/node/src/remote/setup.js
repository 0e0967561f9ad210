'use strict'
/** Set-up of a place on a remote server, with checks of the result. */
const { EYE_HEIGHT } = require('../../../../../skills/code/lib/sight')
const { BadRequest } = require('../channel/errors')
const { countByName } = require('../server/plugins/lib/items')
const { stacksIn, totals } = require('../places/held')
const { byPlace, listOf, vecOf } = require('../server/plugins/lib/positions')
const { isDeepStrictEqual } = require('node:util')
const { sorted } = require('../regions/facts')
const { halvesAt } = require('../server/plugins/lib/doubleChest')
const { slotsIn, slotted } = require('./kinds')
const { planFills } = require('./fills')
const reasons = require('./reasons')

const ATTEMPTS = 3
const COLUMNS_TICKS = 400
const BUILT_TICKS = 10
const MOST_TOLD = 5
const ABOVE = 3
const LINES = 4
const USE_TICKS = 60
const BESIDE = [[0, -1], [1, 0], [0, 1], [-1, 0]]

class Setup {
  /**
   * @param {import('./scene').Scene} scene scene of the place
   * @param {import('./operator').Operator} operator
   * @param {object} commands of commandsFor
   * @param {object} registry
   */
  constructor (scene, operator, commands, registry) {
    this.scene = scene
    this.region = scene.region
    this.operator = operator
    this.commands = commands
    this.registry = registry
    this.Item = require('prismarine-item')(registry)
  }

  /** Move the operator to where it sees the whole box and nobody sees it. */
  async arrive () {
    const { operator, commands, region: { box } } = this
    operator.type(commands.mode(operator.link.name, 'spectator'))
    operator.type(commands.load('add'))
    await this.goAbove()
    if (!await operator.shown(operator.bot, box, COLUMNS_TICKS)) throw reasons.tooFar(operator.server, box)
    await operator.settled()
  }

  async goAbove () {
    const { box: { low, high } } = this.region
    const place = [(low[0] + high[0] + 1) / 2, high[1] + ABOVE, (low[2] + high[2] + 1) / 2]
    await this.operator.go(this.commands.go(this.operator.link.name, place, { yaw: 0, pitch: -Math.PI / 2 }), place)
  }

  /** Fail if the box holds blocks that are not the scenario's. @throws {BadRequest} */
  requireFree (present, wanted) {
    const { box } = this.region
    const foreign = []
    box.forEach((x, y, z, index) => {
      const { name } = this.scene.states.describe(present[index])
      if (present[index] !== wanted[index] && !name.endsWith('air')) foreign.push(`${name} at (${x}, ${y}, ${z})`)
    })
    if (foreign.length === 0) return
    const [low, high] = [box.low, box.high].map(corner => this.region.toServer(corner))
    throw new BadRequest(
      `the box of the scenario, from ${low} to ${high} on the server, holds ${foreign.length} other blocks, as ${foreign.slice(0, MOST_TOLD).join(', ')}; ` +
      'choose another place with ?at=X,Z (multiples of 16), or let them be replaced, and put back at the end, with --overwrite (?overwrite=yes)')
  }

  /**
   * Build the blocks of the box.
   * @returns {Promise<Int32Array>} the states built: the same blocks, with the server's own connections
   * @throws {BadRequest} if the server builds something else
   */
  async build (wanted) {
    const { operator, region: { box } } = this
    let present = this.present()
    for (let attempt = 0; attempt < ATTEMPTS && this.flaws(present, wanted).length > 0; attempt++) {
      await operator.typeAll(planFills(box, present, wanted, state => this.rank(state)).map(cuboid => this.commands.blocks(cuboid)))
      await operator.until(() => this.flaws(this.present(), wanted).length === 0, BUILT_TICKS)
      present = this.present()
    }
    const flaws = this.flaws(present, wanted)
    if (flaws.length === 0) return present
    throw new BadRequest(
      `the server did not build ${flaws.length} blocks of the box, such as ${flaws.slice(0, MOST_TOLD).join(', ')}; it said last: ${operator.lines.at(-1) ?? 'nothing'}`)
  }

  /** Return the present states of the box. */
  present () {
    return this.operator.readStates(this.region.box, this.scene.mapping)
  }

  /** Return the build order of a state: supporting blocks first, attached blocks last. */
  rank (state) {
    const { name, solid } = this.scene.states.describe(state)
    if (name.endsWith('air')) return 0
    return solid && !/_door$|_trapdoor$/.test(name) ? 1 : 2
  }

  /** Return descriptions of blocks that differ from the wanted ones. How fences and panes connect does not matter. */
  flaws (present, wanted) {
    const { states } = this.scene
    const differences = []
    this.region.box.forEach((x, y, z, index) => {
      if (present[index] === wanted[index]) return
      const [there, asked] = [present[index], wanted[index]].map(state => states.describe(state))
      if (there.name === asked.name && isConnected(asked.name)) return
      differences.push(`${states.text(there.stateId)} instead of ${states.text(asked.stateId)} at (${x}, ${y}, ${z})`)
    })
    return differences
  }

  /**
   * Fill containers and check their contents.
   * @param {Array} containers [x, y, z, ITEMS]
   */
  async stock (containers) {
    await this.operator.typeAll(containers.flatMap(([x, y, z, items]) => this.putIn([x, y, z], items)))
    for (const [x, y, z, items] of containers) {
      const content = await this.read([x, y, z])
      if (content !== null && !isDeepStrictEqual(sorted(content), sorted(items))) {
        throw new BadRequest(`the container at (${x}, ${y}, ${z}) holds ${JSON.stringify(content)} on the server instead of ${JSON.stringify(items)}; it said last: ${this.operator.lines.at(-1) ?? 'nothing'}`)
      }
      this.scene.contents.know(vecOf({ x, y, z }), items)
    }
    if (containers.length > 0) await this.goAbove()
  }

  /** Return the commands that set the contents of a container. @returns {string[]} */
  putIn (position, items) {
    const { name } = this.scene.at(vec(position))
    const halves = this.scene.halvesAt(vec(position))
    const size = slotsIn(name)
    try {
      return slotted(this.Item, this.registry, name, items, halves.length).map((stack, slot) =>
        this.commands.contents(listOf(halves[Math.floor(slot / size)]), slot % size, stack))
    } catch (error) {
      if (error instanceof RangeError) throw new BadRequest(`contents at (${position.join(', ')}): ${error.message}`)
      throw error
    }
  }

  /**
   * Return the ITEMS of a container; null if it can neither be opened, as under a block, nor queried.
   * @returns {Promise<object | null>}
   */
  async read (position) {
    const stacks = await this.operator.lookInto(this.commands, position)
    if (stacks === null) return this.asked(position)
    const size = slotsIn(this.scene.at(vec(position)).name) * this.scene.halvesAt(vec(position)).length
    return countByName(stacks.slice(0, size))
  }

  /** Return the contents of a container from the server's data. */
  async asked (position) {
    if (!this.operator.can('data')) return null
    const stacks = []
    for (const half of this.scene.halvesAt(vec(position))) {
      const data = await this.operator.ask(this.commands.dataAt(listOf(half)))
      if (data === null) return null
      stacks.push(...stacksIn(data.Items))
    }
    return totals(stacks)
  }

  /** Return the positions of all containers of a terrain, in order. */
  containers (terrain) {
    const places = []
    const { scene: { states, region: { box } } } = this
    const at = ({ x, y, z }) => states.describe(box.contains(x, y, z) ? terrain.at(x, y, z) : 0)
    terrain.find(state => slotsIn(states.describe(state).name) > 0, (x, y, z) => {
      if (halvesAt(at, vec([x, y, z]))[0].equals(vec([x, y, z]))) places.push([x, y, z])
    })
    return places.sort(byPlace)
  }

  /**
   * Write on the signs of the box, and clear all others.
   * @param {Array} signs [x, y, z, text]
   */
  async write (signs) {
    const { operator, scene } = this
    const wanted = new Map([...scene.signStates().map(([x, y, z]) => [[x, y, z].join(), '']), ...signs.map(([x, y, z, text]) => [[x, y, z].join(), text])])
    const differing = [...wanted].map(([key, text]) => [key.split(',').map(Number), text]).filter(([position, text]) => scene.signText(vec(position)) !== text)
    if (differing.length === 0) return
    if (!operator.can('data')) throw new BadRequest('the scenario has texts on signs, but this server has no /data command to write them; leave the texts out, or use another server')
    for (const [position, text] of differing) {
      const lines = text.split('\n')
      for (let line = 0; line < LINES; line++) operator.type(this.commands.write(position, line, lines[line] ?? ''))
    }
    await operator.settled()
    const flaws = () => differing.filter(([position, text]) => scene.signText(vec(position)) !== text)
    if (await operator.until(() => flaws().length === 0)) return
    const [[position, text]] = flaws()
    throw new BadRequest(`the sign at (${position.join(', ')}) does not show ${JSON.stringify(text)} on the server; it said last: ${operator.lines.at(-1) ?? 'nothing'}`)
  }

  /**
   * Check that agents may use blocks: let an agent open a gate beside its eyes, which exists only for this check.
   * @throws {Unplayable} if the server refuses it
   */
  async requireUse (bot) {
    const { operator, scene, region: { box } } = this
    const eye = bot.entity.position.offset(0, EYE_HEIGHT, 0).floored()
    const cell = BESIDE.map(([x, z]) => eye.offset(x, 0, z)).find(({ x, y, z }) => box.contains(x, y, z) && scene.at({ x, y, z }).name === 'air')
    if (cell === undefined) return
    const [low, high] = [cell, cell].map(({ x, y, z }) => [x, y, z])
    const [shut, air] = ['oak_fence_gate', 'air'].map(name => scene.mapping.registry.blocksByName[name].defaultState)
    const isGate = () => scene.at(cell).name === 'oak_fence_gate'
    operator.type(this.commands.blocks({ state: shut, low, high }))
    await operator.until(isGate)
    await operator.hasSettled(bot, USE_TICKS)
    bot._client.write('block_place', {
      location: cell, direction: 1, hand: 0, cursorX: 0.5, cursorY: 0.5, cursorZ: 0.5, insideBlock: false, sequence: 0
    })
    const opened = await operator.until(() => scene.at(cell).properties.open === true, USE_TICKS)
    operator.type(this.commands.blocks({ state: air, low, high }))
    await operator.settled()
    await operator.until(() => !isGate())
    if (!opened) throw reasons.spawnProtected(operator.server)
  }

  /** Summon the dropped items of the box. */
  async lay (items) {
    const { operator, commands, scene } = this
    operator.type(commands.removeItems())
    await operator.settled()
    scene.items.await(items)
    if (Object.keys(items).length === 0) return
    if (!operator.can('summon')) throw new BadRequest('the scenario has dropped items, but this server has no /summon command to create them; leave the items out, or use another server')
    for (const item of Object.values(items)) operator.type(commands.layItem(item))
    await operator.settled()
    await operator.until(() => scene.items.awaited.length === 0)
  }
}

const vec = ([x, y, z]) => vecOf({ x, y, z })

const isConnected = name => /fence|_wall$|_pane$|iron_bars|stairs|redstone_wire|vine|tripwire/.test(name)

module.exports = { Setup }
