'use strict'
/** Visitor of an exhibit: a client in spectator mode, whom nobody sees and who changes nothing. */
const { TcpEnd } = require('../net/tcpEnd')
const { agentUuid } = require('../bots/bot')
const { vecOf } = require('../server/plugins/lib/positions')
const { loginPacket } = require('../server/login')
const { inside, listing, moving, sign, spawning, wearing } = require('../exhibits/views')

const SPECTATOR = 3
const OWN_NUMBER = 1
const LAST_WINDOW = 100
const FULL = 20
const NOTHING = { present: false }
const NIGHT_VISION = 15
const FOR_EVER = -1

/** Send packets that only clients with a screen need: the end of the loading screen, and light. */
function ease (end, entityId) {
  end.write('game_state_change', { reason: 'level_chunks_load_start', gameMode: 0 })
  end.write('entity_effect', { entityId, effectId: NIGHT_VISION, amplifier: 0, duration: FOR_EVER, hideParticles: 0 })
}

class Visitor {
  /**
   * @param {import('minecraft-protocol').Client} client
   * @param {import('./gallery').Gallery} gallery
   * @param {(visitor: Visitor, command: string) => void} onCommand called with what they type after a slash
   */
  constructor (client, gallery, onCommand) {
    this.gallery = gallery
    this.exhibit = null
    this.window = null
    this.lastWindow = 0
    this.stateId = 0
    this.end = new TcpEnd(client, action => action(), error => this.end.end(`What your game sent was not understood: ${error.message}`))
    this.end.on('chat_command', ({ command }) => onCommand(this, command))
    this.end.on('chat_message', () => this.system('Nobody hears you here: visitors of a belief are not in it.'))
    this.end.on('block_place', ({ location, sequence }) => this.use(vecOf(location), sequence))
    this.end.on('block_dig', ({ location, sequence }) => this.setRight(vecOf(location), sequence))
    this.end.on('window_click', () => this.fill())
    this.end.on('close_window', () => { this.window = null })
  }

  get name () {
    return this.end.username
  }

  system (text) {
    this.end.write('system_chat', { content: this.gallery.serv._createNetworkEncodedChatComponent(text), isActionBar: false })
  }

  /** Move the visitor to a position of the server's world, and show them what is there. */
  enter (exhibit, { x, y, z }) {
    const { end, gallery } = this
    this.exhibit = exhibit
    this.window = null
    end.write('login', loginPacket(gallery.serv, OWN_NUMBER, SPECTATOR))
    end.write('update_view_position', { chunkX: Math.floor(x) >> 4, chunkZ: Math.floor(z) >> 4 })
    for (const column of gallery.columns(exhibit)) end.write('map_chunk', column)
    for (const key of exhibit.signs.keys()) end.write('tile_entity_data', sign(exhibit, gallery.states, key.split(',').map(Number)))
    end.write('player_info', listing(this.name, { uuid: end.uuid, gamemode: SPECTATOR }))
    for (const [label, pose] of exhibit.agents) this.meet(label, pose)
    end.write('position', { x, y, z, yaw: 0, pitch: 0, flags: 0, teleportId: 1 })
    end.write('update_health', { health: FULL, food: FULL, foodSaturation: FULL })
    ease(end, OWN_NUMBER)
  }

  meet (label, pose) {
    const { end, exhibit, gallery: { serv } } = this
    const number = this.gallery.numberOf(exhibit, label)
    end.write('player_info', listing(label))
    end.write('spawn_entity', spawning(exhibit, label, pose, number, serv.registry.entitiesByName.player.id))
    end.write('entity_head_rotation', moving(exhibit, pose, number)[1][1])
    end.write('entity_equipment', wearing(pose, number, serv))
  }

  part (label) {
    this.end.write('entity_destroy', { entityIds: [this.gallery.numberOf(this.exhibit, label)] })
    this.end.write('player_remove', { players: [agentUuid(label)] })
  }

  /**
   * Send changes of the exhibit to the visitor's client.
   * @param {object} changes as in the channel's `show`, except `signs`: positions
   * @param {Set<string>} before agents that were shown until now
   */
  tell ({ blocks, containers, signs, agents }, before) {
    const { end, exhibit, gallery } = this
    for (const [x, y, z, state] of blocks) end.write('block_change', { location: exhibit.toServer([x, y, z]), type: state })
    for (const position of signs) end.write('tile_entity_data', sign(exhibit, gallery.states, position))
    for (const [label, pose] of Object.entries(agents)) {
      if (pose === null) this.part(label)
      else if (before.has(label)) this.move(label, pose)
      else this.meet(label, pose)
    }
    if (containers.length > 0 || blocks.length > 0) this.fill()
  }

  move (label, pose) {
    const number = this.gallery.numberOf(this.exhibit, label)
    for (const [name, packet] of moving(this.exhibit, pose, number)) this.end.write(name, packet)
    this.end.write('entity_equipment', wearing(pose, number, this.gallery.serv))
  }

  /** Handle the use of a block: containers open. */
  use (location, sequence) {
    this.setRight(location, sequence)
    const place = this.exhibit.toOwn(location)
    const inner = inside(this.exhibit, place, this.gallery.states, this.gallery.serv)
    if (inner === null) return
    this.lastWindow = (this.lastWindow % LAST_WINDOW) + 1
    this.window = { id: this.lastWindow, place }
    const title = this.gallery.serv._createNetworkEncodedChatComponent(inner.title)
    this.end.write('open_window', { windowId: this.window.id, inventoryType: inner.type, windowTitle: title })
    this.fill()
  }

  /** Send the contents of the open window; items that the visitor moved go back. */
  fill () {
    if (this.window === null) return
    const inner = inside(this.exhibit, this.window.place, this.gallery.states, this.gallery.serv)
    if (inner === null) {
      this.end.write('close_window', { windowId: this.window.id })
      this.window = null
      return
    }
    this.stateId += 1
    this.end.write('window_items', { windowId: this.window.id, stateId: this.stateId, items: inner.items, carriedItem: NOTHING })
  }

  /** Resend a block and the inventory after the visitor tried to change them. */
  setRight (location, sequence) {
    const { end, exhibit } = this
    end.write('acknowledge_player_digging', { sequenceId: sequence ?? 0 })
    const place = exhibit.toOwn(location)
    if (exhibit.box.contains(place.x, place.y, place.z)) end.write('block_change', { location, type: exhibit.at(place) })
  }
}

module.exports = { ease, Visitor }
