'use strict'
/**
 * Other agents and dropped items that an agent knows of, as entities of a bot. Their ids reveal nothing about other
 * entities: agents are numbered by their names, items in the order in which the agent first saw them.
 */
const { EventEmitter } = require('node:events')
const { Vec3 } = require('vec3')
const { EYE_HEIGHT } = require('../../../../../skills/code/lib/sight')

const FIRST_ITEM = 1000
/** Mineflayer's order of equipment slots. */
const SLOTS = ['main_hand', 'off_hand', 'feet', 'legs', 'chest', 'head']

class Others {
  /**
   * @param {object} bot
   * @param {string[]} names names of all agents that programs may mention
   */
  constructor (bot, names) {
    this.bot = bot
    this.names = [...names].sort()
    this.Item = require('prismarine-item')(bot.registry)
    this.byName = new Map()
    this.items = new Map()
    this.lastItem = FIRST_ITEM
    this.own = null
    this.body = null
  }

  /** Return the entity of the agent's own body, under its id here. */
  get self () {
    if (this.body !== this.bot.entity) {
      this.body = this.bot.entity
      this.own = Object.create(this.body, { id: { value: this.idOf(this.bot.username) } })
    }
    return this.own
  }

  /** Return all entities by id, the agent's own included. @returns {object} */
  get entities () {
    const all = [this.self, ...this.byName.values(), ...this.items.values()]
    return Object.fromEntries(all.map(entity => [entity.id, entity]))
  }

  /** Return all agents by name; the entity of an unseen agent is null. @returns {object} */
  get players () {
    return Object.fromEntries(this.names.map(username => [username, { username, entity: this.entityOf(username), ping: 0, gamemode: 0 }]))
  }

  entityOf (name) {
    return name === this.bot.username ? this.self : this.byName.get(name) ?? null
  }

  idOf (name) {
    return this.names.indexOf(name) + 1
  }

  /** Return the bot's own entity that one of these entities stands for. @returns {object} */
  realOf (entity) {
    if (entity === this.own) return this.bot.entity
    const id = entity.username === undefined ? entity.number : this.bot.players[entity.username]?.entity?.id
    if (!entity.isValid || id === undefined) throw new Error(`${entity.username ?? 'the item'} is not seen any more. Look where it is first.`)
    return Object.create(entity, { id: { value: id } })
  }

  /**
   * Update how an agent is seen now; null: not seen any more.
   * @returns {[string, object][]} events for the program
   */
  see (name, pose) {
    const entityBefore = this.byName.get(name)
    if (pose === null) {
      this.byName.delete(name)
      return entityBefore === undefined ? [] : [['entityGone', gone(entityBefore)]]
    }
    const entity = entityBefore ?? this.agent(name)
    this.byName.set(name, entity)
    entity.position.update(new Vec3(...pose.position))
    entity.equipment = SLOTS.map(slot => this.stack(pose.equipment[slot], 1))
    Object.assign(entity, { yaw: pose.yaw, pitch: pose.pitch, onGround: pose.on_ground, heldItem: entity.equipment[0] })
    return [[entityBefore === undefined ? 'entitySpawn' : 'entityMoved', entity]]
  }

  /**
   * Update an item that lies somewhere; null: not seen any more.
   * @returns {[string, object][]} events for the program
   */
  find (number, item) {
    const entityBefore = this.items.get(number)
    if (item === null) {
      this.items.delete(number)
      return entityBefore === undefined ? [] : [['entityGone', gone(entityBefore)]]
    }
    const entity = entityBefore ?? this.dropped(number)
    this.items.set(number, entity)
    entity.position.update(new Vec3(...item.position))
    entity.stack = this.stack(item.name, item.count)
    return entityBefore === undefined ? [['entitySpawn', entity], ['itemDrop', entity]] : [['entityMoved', entity]]
  }

  agent (username) {
    return this.entity('player', { id: this.idOf(username), username, eyeHeight: EYE_HEIGHT })
  }

  dropped (number) {
    return this.entity('item', { id: ++this.lastItem, number, stack: null })
  }

  entity (name, more) {
    const { type, displayName, category, width, height } = this.bot.registry.entitiesByName[name]
    return Object.assign(new EventEmitter(), {
      type, name, displayName, kind: category, width, height, position: new Vec3(0, 0, 0), velocity: new Vec3(0, 0, 0),
      yaw: 0, pitch: 0, onGround: true, isValid: true, equipment: [], heldItem: null, getDroppedItem () { return this.stack ?? null }
    }, more)
  }

  stack (name, count) {
    return name === undefined ? null : new this.Item(this.bot.registry.itemsByName[name].id, count)
  }
}

function gone (entity) {
  entity.isValid = false
  return entity
}

module.exports = { Others }
