'use strict'
/** Where people come in: a TCP port, and who may take an agent's place in the region that is open. */
const { once } = require('node:events')
const minecraft = require('minecraft-protocol')
const { states } = minecraft
const { TcpEnd } = require('../net/tcpEnd')
const versions = require('../versions')
const { CannotListen } = require('./cannotListen')

// More than there are agents; one who comes too many is told so by name.
const MOST_CONNECTIONS = 1000
// Ticks after which one who stands has arrived.
const STANDING_TICKS = 10
const NIGHT_VISION = 15
const FOR_EVER = -1
// What a handshake asks for who wants to play.
const LOGIN = 2
const MOVES = ['position', 'position_look']

class PersonEnd extends TcpEnd {
  /** @param {(place: {x: number, y: number, z: number}) => boolean} mayBeAt whether somebody may go there */
  constructor (client, mayBeAt, report) {
    super(client, action => action(), report)
    this.mayBeAt = mayBeAt
    this.player = null
  }

  /** What a client says of where it is holds only within the box. */
  deliver (name, params) {
    if (MOVES.includes(name) && !this.mayBeAt(params)) this.player?.sendSelfPosition()
    else super.deliver(name, params)
  }
}

class Door {
  /** @param {import('./liveRegions').LiveRegions} regions */
  constructor (regions) {
    this.regions = regions
    this.invited = new Set()
    // Who is there: player, and for how many ticks where.
    this.present = new Map()
    regions.onTick = region => this.watch(region)
  }

  /** @returns {Promise<number>} the port; 0 asked for any. @throws {CannotListen} */
  async listen ({ host, port }) {
    const listening = minecraft.createServer({
      host, port, version: versions.minecraft, 'online-mode': false, maxPlayers: MOST_CONNECTIONS, motd: 'BeliefNest', hideErrors: true,
      // The library would answer with its error, which is no text.
      errorHandler: client => client.socket.destroy()
    })
    // Before the library's own, which ends such a connection without a word.
    listening.prependListener('connection', client => client.once('set_protocol', asked => refuseVersion(client, asked, listening.mcversion)))
    listening.on('playerJoin', client => this.greet(client))
    try {
      await once(listening, 'listening')
    } catch (error) {
      throw new CannotListen(host, port, error)
    }
    listening.on('error', error => process.stderr.write(`port of people: ${error.message}\n`))
    return listening.socketServer.address().port
  }

  /** Says who may come; who is there and may no longer be is sent away. @returns {string[]} who is there */
  invite (names) {
    this.invited = new Set(names)
    for (const [agent, { player }] of this.present) {
      if (!this.invited.has(agent)) player._client.end(`${agent} is played by BeliefNest from now on`)
    }
    return [...this.present.keys()].sort()
  }

  isPerson (agent) {
    return this.invited.has(agent)
  }

  greet (client) {
    const refusal = this.refusal(client.username)
    if (refusal !== null) {
      client.end(refusal)
      return
    }
    this.inTurn(() => { if (!client.ended) this.letIn(client) })
  }

  /** @returns {string | null} why somebody cannot come in, as a sentence for them */
  refusal (name) {
    const { open } = this.regions
    const free = [...this.invited].filter(agent => !this.present.has(agent))
    const who = free.length === 0 ? 'nobody else is awaited now' : `come as ${free.join(' or ')}`
    if (open === null) return 'Nothing is being played here at this moment; come again when it is'
    if (this.present.has(name)) return `${name} is here already; ${who}`
    if (this.invited.has(name) && open.bodies.has(name)) return null
    if (open.bodies.has(name)) return `${name} is played by BeliefNest; ${who}`
    return `There is no ${name} in this scenario; ${who}`
  }

  letIn (client) {
    const { regions } = this
    const { open: region } = regions
    const agent = client.username
    if (this.refusal(agent) !== null) {
      client.end(this.refusal(agent))
      return
    }
    const end = new PersonEnd(client, place => isPlace(place) && region.contains(place), error => blame(end, error))
    end.player = regions.bodies.seat(region, end)
    this.present.set(agent, { player: end.player, ticks: 0, place: null })
    end.on('end', () => {
      this.present.delete(agent)
      this.inTurn(() => regions.open === region ? regions.bodies.standIn(region, agent) : null)
    })
    equip(end, region)
  }

  inTurn (action) {
    const { regions } = this
    regions.door = regions.door.then(action).catch(error => { regions.failure = error })
  }

  /** Who has come to stand after walking has moved there, as one whom a program lets walk. */
  watch (region) {
    for (const standing of this.present.values()) {
      const { player, place } = standing
      if (place === null || !place.equals(player.position)) Object.assign(standing, { place: player.position.clone(), ticks: 0 })
      else if (++standing.ticks === STANDING_TICKS) player.report({ kind: 'move_to', detail: { destination: region.toScenario(player.position.floored()) } })
    }
  }
}

/** Says so to a game of another version than ours; who only asks who is here gets an answer all the same. */
function refuseVersion (client, { protocolVersion, nextState }, { version, minecraftVersion }) {
  if (protocolVersion === version || nextState !== LOGIN) return
  client.state = states.LOGIN
  client.end(`This is Minecraft ${minecraftVersion}; start the game in that version`)
}

/** What a game with a screen asks for besides: an end to waiting, and light. */
function equip (end, region) {
  end.write('game_state_change', { reason: 'level_chunks_load_start', gameMode: 0 })
  end.write('entity_effect', { entityId: end.player.id, effectId: NIGHT_VISION, amplifier: 0, duration: FOR_EVER, hideParticles: 0 })
  const others = [...region.bodies.keys()].filter(agent => agent !== end.username).sort()
  end.player.system(`You are ${end.username}. ${others.length > 0 ? `Here are ${others.join(', ')}. ` : ''}What you do and say is recorded.`)
}

/** What a person cannot do they are told; a client that sends what makes no sense has to go. */
function blame (end, error) {
  if (error instanceof RangeError && end.player !== null) {
    end.player.system(error.message)
    return
  }
  process.stderr.write(`${end.username}: ${error.stack}\n`)
  end.end(`What your game sent was not understood: ${error.message}`)
}

function isPlace ({ x, y, z }) {
  return [x, y, z].every(Number.isFinite)
}

module.exports = { Door }
