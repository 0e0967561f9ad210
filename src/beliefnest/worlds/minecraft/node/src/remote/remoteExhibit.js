'use strict'
/**
 * Exhibit on a remote server: the operator's commands build and change it, a guide looks at it, and each agent in it
 * is a player.
 */
const { Exhibit } = require('../exhibits/exhibit')
const { Place } = require('../regions/place')
const { Terrain } = require('../regions/terrain')
const { keyOf, listOf, vecOf } = require('../server/plugins/lib/positions')
const { halvesAt } = require('../server/plugins/lib/doubleChest')
const { slotsIn, slotted } = require('./kinds')
const { Guide } = require('./guide')
const { Link } = require('./link')
const { Marker } = require('./marker')

// Recorder that ignores everything: events in an exhibit belong to no simulator.
const DEAF = { blockChanged () {}, signChanged () {}, event () {} }

/** Log a failure of an exhibit; it must not end the real world. */
const note = (who, error) => process.stderr.write(`${who}: ${error.stack}\n`)

class RemoteExhibit {
  /**
   * @param {object} description EXHIBIT of the channel
   * @param {string} guideName name of the guide's player
   * @param {import('./remoteRegions').RemoteRegions} regions
   */
  constructor (description, guideName, regions) {
    this.regions = regions
    this.exhibit = new Exhibit(description)
    const { name, box, origin } = this.exhibit
    const place = new Place({ name, box, origin, tick: 0, agentNames: [] })
    place.recorder = DEAF
    const { operator } = regions
    this.connect = player => regions.connection(player, origin)
    const link = new Link(guideName, () => this.connect(guideName), operator.server, operator.server.patience * 1000)
    this.guide = new Guide(link, operator)
    Object.assign(this, regions.tools(place, this.guide, error => note(name, error)))
    link.on('begun', (bot, client) => this.scene.attach(bot, client))
    link.on('back', () => this.later(() => this.refresh()))
    link.on('failed', error => note(guideName, error))
    this.markers = new Map()
    // Stacks that each container was given, by position.
    this.filled = new Map()
    this.saved = null
    this.turn = Promise.resolve()
    this.onBack = () => this.later(() => this.refresh())
  }

  /** Build the exhibit. @throws {BadRequest} if the place holds other blocks, or the server builds something else */
  async build () {
    const { exhibit, guide, regions, scene, setup } = this
    await guide.link.open()
    await setup.arrive()
    const present = setup.present()
    if (!regions.server.overwrite) setup.requireFree(present, exhibit.blocks.dense())
    this.saved = await regions.save({ scene, setup }, present)
    await this.fill()
    await Promise.all([...exhibit.agents].map(([name, pose]) => this.meet(name, pose)))
    guide.operator.link.on('back', this.onBack)
  }

  async fill () {
    const { exhibit, scene, setup } = this
    scene.settle(Terrain.of(await setup.build(exhibit.blocks.dense()), exhibit.box))
    await setup.stock(setup.containers(scene.blocks).map(position => {
      const items = exhibit.containers.get(position.join())?.items ?? {}
      this.filled.set(position.join(), this.stacks(position, items))
      return [...position, items]
    }))
    await setup.write(this.signs)
  }

  get signs () {
    return [...this.exhibit.signs].map(([key, text]) => [...key.split(',').map(Number), text])
  }

  stacks (position, items) {
    const { Item, registry } = this.setup
    const place = vecOf({ x: position[0], y: position[1], z: position[2] })
    return slotted(Item, registry, this.shown(place).name, items, this.halvesAt(place).length)
  }

  shown (place) {
    return this.scene.states.describe(this.exhibit.at(place))
  }

  halvesAt (place) {
    return halvesAt(each => this.shown(each), place)
  }

  /** Restore everything after the guide or the operator was disconnected. */
  async refresh () {
    await this.setup.arrive()
    this.scene.settle(Terrain.of(this.setup.present(), this.exhibit.box))
    await this.fill()
    for (const marker of this.markers.values()) if (marker.link.isReady) await marker.begin()
  }

  later (action) {
    this.turn = this.turn.then(action).catch(error => note(this.exhibit.name, error))
  }

  /** Change the parts that differ, one change after another; the caller does not wait. */
  show ({ tick, ...changes }, now) {
    const { exhibit } = this
    exhibit.lag = Math.max(exhibit.lag, now - tick)
    const { signs } = exhibit.take(changes)
    this.later(async () => {
      this.change(changes)
      if (signs.length > 0) await this.setup.write(this.signs)
    })
    for (const [name, pose] of Object.entries(changes.agents)) {
      if (pose === null) this.part(name)
      else if (this.markers.has(name)) this.markers.get(name).move(pose)
      else this.meet(name, pose).catch(error => note(name, error))
    }
  }

  change ({ blocks, containers }) {
    const { guide, commands, setup, exhibit } = this
    for (const [x, y, z, state] of blocks.toSorted(([, , , one], [, , , other]) => setup.rank(one) - setup.rank(other))) {
      guide.type(commands.blocks({ state, low: [x, y, z], high: [x, y, z] }))
      this.filled.delete(keyOf({ x, y, z }))
    }
    const places = [...blocks, ...containers].map(([x, y, z]) => vecOf({ x, y, z }))
    for (const place of places) {
      const size = slotsIn(this.shown(place).name)
      const halves = this.halvesAt(place)
      if (size === 0 || !halves[0].equals(place)) continue
      const wanted = this.stacks(listOf(place), exhibit.containers.get(keyOf(place))?.items ?? {})
      const stacks = this.filled.get(keyOf(place)) ?? []
      wanted.forEach((stack, slot) => {
        const before = stacks[slot] ?? null
        if (before?.name !== stack?.name || before?.count !== stack?.count) guide.type(commands.contents(listOf(halves[Math.floor(slot / size)]), slot % size, stack))
      })
      this.filled.set(keyOf(place), wanted)
    }
  }

  async meet (name, pose) {
    this.regions.unseen.add(name)
    const marker = new Marker(name, () => this.connect(name), this.guide.operator, this.commands)
    this.markers.set(name, marker)
    await marker.open(pose)
  }

  part (name) {
    const marker = this.markers.get(name)
    this.markers.delete(name)
    this.later(() => marker?.close())
  }

  /** Remove all players, and restore the blocks that were there before. */
  async close () {
    const { guide, setup, scene, saved, regions: { server } } = this
    guide.operator.link.off('back', this.onBack)
    await this.turn
    await Promise.all([...this.markers.values()].map(marker => marker.close()))
    if (guide.link.isHere && guide.operator.link.isHere) {
      if (saved !== null && !server.keep) {
        scene.settle(Terrain.of(await setup.build(saved.states), this.exhibit.box))
        await setup.stock(saved.containers)
      }
      guide.type(this.commands.load('remove'))
      await guide.operator.settled()
    }
    await guide.link.close()
  }
}

module.exports = { RemoteExhibit }
