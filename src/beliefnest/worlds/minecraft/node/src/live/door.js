'use strict'
/** Entrance for people: a TCP port, and the rules who may take an agent's place in the open region. */
const { once } = require('node:events')
const { setTimeout: sleep } = require('node:timers/promises')
const minecraft = require('minecraft-protocol')
const { Vec3 } = require('vec3')
const { TcpEnd } = require('../net/tcpEnd')
const versions = require('../versions')
const { Earshot } = require('./earshot')
const { Gallery } = require('./gallery')
const { keepAlive } = require('./keepAlive')
const { Standstill } = require('./standstill')
const { ease } = require('./visitor')
const { canGo } = require('./way')

// More than there are agents, so that the door can tell an extra player why they are refused.
const MOST_CONNECTIONS = 1000
// Number of ticks after which a standing person counts as arrived.
const STANDING_TICKS = 10
// Value of a handshake's `nextState` for a client that wants to play.
const LOGIN = 2
const MOVES = ['position', 'position_look']
const TURNS = ['look', 'position_look']
const REALITY = '/'
const GOODBYE_MS = 500
const NO_LONGER_SHOWN = 'What you looked at is no longer shown'
// Packet that makes the sound of a picked-up item, wherever that is.
const PICKED_UP = 'collect'
// The game's own `/tp`, for oneself.
const TRAVEL = /^(?:minecraft:)?(?:tp|teleport)(?: @s| (?<who>\w+))? (?<x>-?\d+(?:\.\d+)?) (?<y>-?\d+(?:\.\d+)?) (?<z>-?\d+(?:\.\d+)?)$/

class PersonEnd extends TcpEnd {
  /**
   * Wrap the connection of a person who plays an agent.
   * @param {import('minecraft-protocol').Client} client
   * @param {(place: {x: number, y: number, z: number}) => boolean} mayBeAt returns true if the person may go there
   * @param {import('./standstill').Standstill} standstill
   * @param {(error: Error) => void} report called with errors of a packet's handlers
   */
  constructor (client, mayBeAt, standstill, report) {
    super(client, action => action(), report)
    this.standstill = standstill
    this.mayBeAt = mayBeAt
    this.player = null
  }

  /** Send only the person's own pickups: the sound of others' would reveal unheard acts. */
  write (name, params) {
    if (name !== PICKED_UP || params.collectorEntityId === this.player?.id) super.write(name, params)
  }

  /** Accept a position or direction of the client only if it is valid, inside the box and reachable. */
  deliver (name, params) {
    if (this.standstill.takes(this, name, params)) return
    const isWrong = (MOVES.includes(name) && !this.mayBeAt(params)) || (TURNS.includes(name) && !isDirection(params))
    if (isWrong) this.player?.sendSelfPosition()
    else super.deliver(name, params)
  }
}

/** Error for a port that cannot be opened. The message says which port, and what to do. */
class CannotListen extends Error {
  constructor (host, port, { code, message }) {
    const why = { EADDRINUSE: 'another program listens there', EACCES: 'only the system may listen there', EADDRNOTAVAIL: 'this machine has no such address' }[code] ?? message
    super(`people cannot come in at ${host}:${port}: ${why}; give another port, or 0 for any that is free`)
  }

  /** Kind of the failure for the channel: the world failed, and the message says everything. */
  get kind () { return 'world' }
}

class Door {
  /** @param {import('./liveRegions').LiveRegions} regions */
  constructor (regions) {
    this.regions = regions
    this.listening = null
    this.invited = new Set()
    // People who are present: their player, and for how many ticks they have stood where.
    this.present = new Map()
    regions.onTick = region => this.watch(region)
    this.gallery = new Gallery(regions.serv)
    this.standstill = new Standstill()
    this.earshot = new Earshot(regions.serv, agent => this.present.get(agent)?.player ?? null)
    regions.onFrame = frame => this.earshot.framed(frame)
    regions.onForget = () => this.earshot.forget()
    const refuse = regions.serv.command
    regions.serv.command = (player, command) => {
      const end = this.endOf(player)
      if (end === null || !this.travel(end, command, text => player.system(text))) refuse(player, command)
    }
  }

  /** Open the port; 0 chooses any free one. @returns {Promise<number>} the port */
  async listen ({ host, port }) {
    const listening = minecraft.createServer({
      host, port, version: versions.minecraft, 'online-mode': false, maxPlayers: MOST_CONNECTIONS, motd: 'BeliefNest', hideErrors: true, keepAlive: false,
      // The library would answer with an error object instead of a text.
      errorHandler: client => client.socket.destroy()
    })
    // Run before the library's own listener, which ends such a connection without a message.
    listening.prependListener('connection', client => client.once('set_protocol', asked => refuseVersion(client, asked, listening.mcversion)))
    listening.on('playerJoin', client => {
      keepAlive(client)
      this.greet(client)
    })
    try {
      await once(listening, 'listening')
    } catch (error) {
      throw new CannotListen(host, port, error)
    }
    listening.on('error', error => process.stderr.write(`port of people: ${error.message}\n`))
    this.listening = listening
    return listening.socketServer.address().port
  }

  /** Disconnect everybody with a sentence. Resolve when all clients have received it, or after a time limit. */
  async close () {
    const clients = Object.values(this.listening.clients)
    this.listening.socketServer.close()
    const gone = clients.map(client => once(client, 'end'))
    for (const client of clients) client.end('The run is over')
    await Promise.race([Promise.all(gone), sleep(GOODBYE_MS)])
  }

  /**
   * Set the agents whose places people may take. Disconnect the others. Tell visitors who may play again.
   * @returns {string[]} agents that people play now
   */
  invite (names) {
    const before = this.invited
    this.invited = new Set(names)
    for (const visitor of this.gallery.visitors) {
      if (this.invited.has(visitor.name) && !before.has(visitor.name)) this.inTurn(() => this.callBack(visitor))
    }
    for (const [agent, { player }] of this.present) {
      if (!this.invited.has(agent)) player._client.end(`${agent} is played by BeliefNest from now on`)
    }
    return [...this.present.keys()].sort()
  }

  /** Stop or resume time, and tell the people who play. */
  async pause (isPaused) {
    if (!await this.regions.pause(isPaused)) return
    for (const { player } of this.present.values()) player.system(isPaused ? 'Time stands still.' : 'Time goes on.')
    if (isPaused) this.standstill.isOn = true
    else for (const end of this.standstill.end()) if (this.present.get(end.username)?.player._client === end) this.greet(end.release())
  }

  /**
   * Let a client in as its agent, or else as a visitor. If neither is possible, end the connection with the reason, or
   * with `parting` if it is given.
   */
  greet (client, parting) {
    this.inTurn(() => {
      if (client.ended) return
      const refusal = this.refusal(client.username)
      if (refusal === null) this.letIn(client)
      else if (this.mayVisit(client.username)) this.visit(client, this.gallery.entrance)
      else client.end(parting ?? refusal)
    })
  }

  /** Return true if somebody who is not an agent can come as a visitor: a region is open and something is shown. */
  mayVisit (name) {
    const { open } = this.regions
    return open !== null && !open.bodies.has(name) && this.gallery.exhibits.size > 0
  }

  /** Return the connection of the person who plays an agent; null if a bot does. */
  endOf ({ agent, _client: end }) {
    return this.present.get(agent)?.player._client === end ? end : null
  }

  /**
   * Handle `/tp X Y Z` of a person, agent or visitor: take them there if they may go.
   * @returns {boolean} true if the command is this one
   */
  travel (end, command, tell) {
    const { x, y, z, who = end.username } = TRAVEL.exec(command)?.groups ?? {}
    if (x === undefined || this.gallery.exhibits.size === 0) return false
    const [place, isSeated] = [{ x: Number(x), y: Number(y), z: Number(z) }, this.present.has(end.username)]
    const exhibit = this.gallery.at(place)
    if (who !== end.username) tell('You can go to other places yourself alone.')
    else if (exhibit === null) tell(`Nothing stands there. ${this.gallery.directions()}`)
    else if (exhibit.name !== REALITY) this.visit(end.release(), { exhibit, place: centred(place) })
    else if (isSeated) tell('You are there already, and walk.')
    else this.goToReality(end.release(), centred(place))
    return true
  }

  /** Take a client to reality: as its agent if that is possible, or else as a visitor. */
  goToReality (client, place) {
    this.inTurn(() => {
      if (client.ended) return
      const exhibit = this.gallery.at(place)
      if (this.refusal(client.username) === null) this.letIn(client)
      else if (exhibit === null) client.end(NO_LONGER_SHOWN)
      else this.visit(client, { exhibit, place })
    })
  }

  /** Give a visitor their agent back: at once if they visit reality; otherwise tell them how to return. */
  callBack (visitor) {
    if (!this.gallery.visitors.has(visitor) || this.refusal(visitor.name) !== null) return
    if (visitor.exhibit.name === REALITY) this.letIn(visitor.end.release())
    else visitor.system(`You can be ${visitor.name} again. ${this.gallery.directions()}`)
  }

  visit (client, { exhibit, place }) {
    const visitor = this.gallery.admit(client, (each, command) => {
      if (!this.travel(each.end, command, text => each.system(text))) each.system(`Visitors have one command, /tp X Y Z. ${this.gallery.directions()}`)
    })
    visitor.enter(exhibit, place)
    const away = this.regions.open?.bodies.has(visitor.name) && !this.invited.has(visitor.name) ? `${visitor.name} is played by BeliefNest now. ` : ''
    visitor.system(`${greeting(exhibit)} ${away}${this.gallery.directions()}`)
  }

  /** Close an exhibit. Agents return to where they stand; visitors are disconnected. */
  closeExhibit (name) {
    for (const { end } of this.gallery.close(name)) this.greet(end.release(), NO_LONGER_SHOWN)
  }

  /** Return why somebody cannot come in, as a sentence for them; null if they can. @returns {string | null} */
  refusal (name) {
    const { open } = this.regions
    const free = [...this.invited].filter(agent => !this.present.has(agent))
    const look = this.gallery.exhibits.size > 0 && open?.bodies.has(name) ? ', or by another name to look' : ''
    const who = `${free.length === 0 ? 'nobody else is awaited now' : `come as ${free.join(' or ')}`}${look}`
    if (open === null) return 'Nothing is being played here at this moment; come again later'
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
    const shapesAt = (x, y, z) => regions.serv.blocks.at(new Vec3(x, y, z)).shapes
    const mayBeAt = place => isPlace(place) && region.contains(place) && canGo(shapesAt, end.player.position, place)
    const end = new PersonEnd(client, mayBeAt, this.standstill, error => blame(end, error))
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

  /** Report a `move_to` of each person who has come to stand after walking, as for an agent that a program moved. */
  watch (region) {
    for (const standing of this.present.values()) {
      const { player, place } = standing
      if (place === null || !place.equals(player.position)) Object.assign(standing, { place: player.position.clone(), ticks: 0 })
      else if (++standing.ticks === STANDING_TICKS) player.report({ kind: 'move_to', detail: { destination: region.toScenario(player.position.floored()) } })
    }
  }
}

/** Disconnect a client of another game version, with a message. Status queries are answered all the same. */
function refuseVersion (client, asked, { version, minecraftVersion }) {
  if (asked.protocolVersion === version || asked.nextState !== LOGIN) return
  // The library would send its own answer, and would let the client in if it stays. Hide the version from it, and
  // remove its login listener.
  asked.protocolVersion = version
  client.removeAllListeners('login_start')
  setImmediate(() => client.end(`This is Minecraft ${minecraftVersion}; start the game in that version`))
}

/** Tell a person who begins to play an agent who else is there. */
function equip (end, region) {
  ease(end, end.player.id)
  const others = [...region.bodies.keys()].filter(agent => agent !== end.username).sort()
  end.player.system(`You are ${end.username}. ${others.length > 0 ? `Here are ${others.join(', ')}. ` : ''}What you do and say is recorded.`)
}

/** Move whole numbers to the middle of a block, as the game's `/tp` does. */
function centred ({ x, y, z }) {
  const middle = value => Number.isInteger(value) ? value + 0.5 : value
  return { x: middle(x), y, z: middle(z) }
}

function greeting ({ name }) {
  const what = name === REALITY ? 'the real world' : `${name}: what ${name.slice(1).split('/').join(' believes that ')} believes`
  return `You look at ${what}. Nobody sees or hears you, and nothing can be changed.`
}

/** Tell a person about an act that was refused; disconnect a client whose packets make no sense. */
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

function isDirection ({ yaw, pitch }) {
  return [yaw, pitch].every(Number.isFinite)
}

module.exports = { Door }
