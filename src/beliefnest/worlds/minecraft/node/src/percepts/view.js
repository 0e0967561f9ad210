'use strict'
/**
 * View of a bot, limited to the perceptions and memories of its agent. A program that reads only percepts, and its
 * skills, get the view instead of the bot. The body is the bot's own: it acts in the world, collides with it and holds
 * the bot's items. All methods that read the surrounding world answer from the agent's knowledge, which `update`
 * changes after each tick.
 */
const { EventEmitter } = require('node:events')
const rayTrace = require('mineflayer/lib/plugins/ray_trace')
const { KnownWorld } = require('./knownWorld')
const { Others } = require('./others')
const { Walker } = require('./walker')

const ANNOUNCED = Object.keys(require('../sandbox/policy/events').announced)

/** Events about the agent's own body or acts, which the bot emits. All other events come from percepts. */
const OF_THE_BODY = new Set([
  'health', 'breath', 'death', 'spawn', 'respawn', 'rain', 'time', 'move', 'forcedMove', 'physicsTick', 'physicTick', 'sleep', 'wake',
  'experience', 'diggingCompleted', 'diggingAborted', 'windowOpen', 'windowClose', 'heldItemChanged', 'usedFirework'
])

class View {
  /**
   * @param {object} options
   * @param {object} options.bot
   * @param {import('../time/clock').Clock} options.clock
   * @param {import('../regions/box').Box} options.box
   * @param {string[]} options.names names of the agents that programs may mention
   * @param {object} options.percepts PERCEPTS of the channel, with all blocks as `states`
   */
  constructor ({ bot, clock, box, names, percepts: { states, ...changes } }) {
    this.body = bot
    this.emitter = new EventEmitter().setMaxListeners(0)
    this.forwarded = []
    this.collected = []
    this.waiting = []
    this.knownWorld = new KnownWorld({ registry: bot.registry, box, states, beyond: bot.world })
    this.others = new Others(bot, names)
    this.bot = this.made()
    this.walker = new Walker(this.bot, this.knownWorld, clock)
    this.onCollect = (collector, collected) => this.collected.push({ name: collector.username, number: collected.id })
    bot.on('playerCollect', this.onCollect)
    this.onSignOpen = ({ position }) => this.emitter.emit('signOpen', this.knownWorld.getBlock(position))
    bot.on('signOpen', this.onSignOpen)
    this.learn(changes)
    // Events before the program could listen: since the interruption, if the program is resumed.
    this.backlog = changes.announced ?? []
  }

  /** Return the bot object for the program. */
  made () {
    const { body, knownWorld, others } = this
    const view = Object.create(body, {
      world: { value: knownWorld },
      entity: { get: () => others.self },
      entities: { get: () => others.entities },
      players: { get: () => others.players },
      player: { get: () => others.players[body.username] },
      // Plugins assign these properties; on the bot they are read-only.
      pathfinder: { value: null, writable: true }
    })
    rayTrace(view)
    return Object.assign(view, this.events(), looking(view, knownWorld), touching(body, others), { perceived: () => this.perceived() })
  }

  events () {
    const { body, emitter } = this
    const add = (event, listener, once) => {
      if (!OF_THE_BODY.has(event)) emitter[once ? 'once' : 'on'](event, listener)
      else {
        this.forwarded.push({ event, listener })
        body[once ? 'once' : 'on'](event, listener)
      }
      return this.bot
    }
    const remove = (event, listener) => {
      if (!OF_THE_BODY.has(event)) emitter.removeListener(event, listener)
      else {
        this.forwarded = this.forwarded.filter(each => each.event !== event || each.listener !== listener)
        body.removeListener(event, listener)
      }
      return this.bot
    }
    const removeAll = event => {
      for (const each of this.forwarded.filter(each => each.event === event)) remove(event, each.listener)
      emitter.removeAllListeners(event)
      return this.bot
    }
    return {
      on: (event, listener) => add(event, listener, false),
      addListener: (event, listener) => add(event, listener, false),
      once: (event, listener) => add(event, listener, true),
      off: remove,
      removeListener: remove,
      removeAllListeners: removeAll,
      emit: (event, ...values) => emitter.emit(event, ...values)
    }
  }

  /** Resolve when the percepts of this tick have arrived. */
  perceived () {
    return new Promise(resolve => { this.waiting.push(resolve) })
  }

  /** Apply PERCEPTS, the changes since the last ones; null if nothing has changed. */
  update (changes) {
    // Keep the backlog until the program has a listener.
    const listens = ANNOUNCED.some(event => this.emitter.listenerCount(event) > 0)
    const before = listens ? this.backlog.splice(0) : []
    const events = [...before, ...(changes === null ? [] : this.learn(changes))]
    for (const [event, ...values] of events) this.emitter.emit(event, ...values)
    this.collected = []
    for (const resolve of this.waiting.splice(0)) resolve()
  }

  /** Apply changes. Return the events that announce them, each a name with values. @returns {Array[]} */
  learn ({ blocks = [], signs = null, agents = {}, items = {}, announced = [] }) {
    const events = []
    if (signs !== null) this.knownWorld.readSigns(signs)
    for (const [x, y, z, state] of blocks) {
      const { before, after } = this.knownWorld.learn(x, y, z, state)
      this.walker.learn(before, after)
      events.push(['blockUpdate', before, after], [`blockUpdate:(${x}, ${y}, ${z})`, before, after])
    }
    for (const [name, pose] of Object.entries(agents)) events.push(...this.others.see(name, pose))
    const taken = this.collected.map(({ name, number }) => [this.others.entityOf(name), this.others.items.get(number)])
    for (const [number, item] of Object.entries(items)) events.push(...this.others.find(Number(number), item))
    // Only if the agent sees the collector and has seen the item lie there.
    events.push(...taken.filter(pair => pair.every(Boolean)).map(pair => ['playerCollect', ...pair]))
    return [...events, ...announced]
  }

  /** Release the bot and return it. @returns {object} */
  close () {
    for (const { event, listener } of this.forwarded.splice(0)) this.body.removeListener(event, listener)
    this.body.removeListener('playerCollect', this.onCollect)
    this.body.removeListener('signOpen', this.onSignOpen)
    this.emitter.removeAllListeners()
    return this.body
  }
}

/** Return the methods that look at the world. */
function looking (view, knownWorld) {
  const findBlocks = ({ matching, point, maxDistance = 16, count = 1 }) => {
    const types = [matching].flat()
    const matches = typeof matching === 'function' ? matching : block => types.includes(block.type)
    return knownWorld.find(matches, (point ?? view.entity.position).floored(), maxDistance, count)
  }
  return {
    blockAt: place => knownWorld.getBlock(place),
    findBlocks,
    findBlock: options => {
      const [place] = findBlocks({ ...options, count: 1 })
      return place === undefined ? null : knownWorld.getBlock(place)
    },
    canSeeBlock: ({ position }) => {
      const eye = view.entity.position.offset(0, view.entity.eyeHeight, 0)
      const way = position.offset(0.5, 0.5, 0.5).minus(eye)
      const meets = (block, ray) => ray.intersect(block.shapes, block.position) !== null || block.position.equals(position)
      return knownWorld.raycast(eye, way.normalize(), eye.distanceTo(position), meets)?.position.equals(position) ?? false
    },
    nearestEntity: (matches = () => true) => {
      const far = ({ position }) => position.distanceTo(view.entity.position)
      return Object.values(view.entities).filter(entity => entity !== view.entity && matches(entity))
        .reduce((best, entity) => (best === null || far(entity) < far(best) ? entity : best), null)
    }
  }
}

/** Return the methods that act on others, translated to the game's entity ids. */
function touching (body, others) {
  const acting = name => (entity, ...rest) => body[name](others.realOf(entity), ...rest)
  const opening = name => (target, ...rest) => body[name](target.stateId === undefined ? others.realOf(target) : target, ...rest)
  return {
    activateEntity: acting('activateEntity'),
    useOn: acting('useOn'),
    attack: acting('attack'),
    openContainer: opening('openContainer'),
    openChest: opening('openChest')
  }
}

module.exports = { View }
