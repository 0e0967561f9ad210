'use strict'
/** Where people come in: a TCP port, and who may take an agent's place in the region that is open. */
const { once } = require('node:events')
const { setTimeout: sleep } = require('node:timers/promises')
const minecraft = require('minecraft-protocol')
const { Vec3 } = require('vec3')
const { TcpEnd } = require('../net/tcpEnd')
const versions = require('../versions')
const { CannotListen } = require('./cannotListen')
const { Earshot } = require('./earshot')
const { ease } = require('./ease')
const { Gallery } = require('./gallery')
const { Standstill } = require('./standstill')
const { canGo } = require('./way')

// More than there are agents; one who comes too many is told so by name.
const MOST_CONNECTIONS = 1000
// Ticks after which one who stands has arrived.
const STANDING_TICKS = 10
// What a handshake asks for who wants to play.
const LOGIN = 2
const MOVES = ['position', 'position_look']
const TURNS = ['look', 'position_look']
const REALITY = '/'
const GOODBYE_MS = 500
const NO_LONGER_SHOWN = 'What you looked at is no longer shown'
// Makes the sound of a thing being picked up, wherever that is.
const PICKED_UP = 'collect'
// The game's own `/tp`, of oneself.
const TRAVEL = /^(?:minecraft:)?(?:tp|teleport)(?: @s| (?<who>\w+))? (?<x>-?\d+(?:\.\d+)?) (?<y>-?\d+(?:\.\d+)?) (?<z>-?\d+(?:\.\d+)?)$/

class PersonEnd extends TcpEnd {
  /**
   * @param {import('minecraft-protocol').Client} client
   * @param {(place: {x: number, y: number, z: number}) => boolean} mayBeAt whether somebody may go there
   * @param {import('./standstill').Standstill} standstill
   * @param {(error: Error) => void} report hears what a packet's handlers throw
   */
  constructor (client, mayBeAt, standstill, report) {
    super(client, action => action(), report)
    this.standstill = standstill
    this.mayBeAt = mayBeAt
    this.player = null
  }

  /** Others' deeds are not heard: what makes a sound in the game is told of the person's own alone. */
  write (name, params) {
    if (name !== PICKED_UP || params.collectorEntityId === this.player?.id) super.write(name, params)
  }

  /** What a client says of where it is and looks holds only within the box, where a way leads, and if it is a place and a direction. */
  deliver (name, params) {
    if (this.standstill.takes(this, name, params)) return
    const isWrong = (MOVES.includes(name) && !this.mayBeAt(params)) || (TURNS.includes(name) && !isDirection(params))
    if (isWrong) this.player?.sendSelfPosition()
    else super.deliver(name, params)
  }
}

class Door {
  /** @param {import('./liveRegions').LiveRegions} regions */
  constructor (regions) {
    this.regions = regions
    this.listening = null
    this.invited = new Set()
    // Who is there: player, and for how many ticks where.
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
    this.listening = listening
    return listening.socketServer.address().port
  }

  /** Send everybody away with a sentence; resolves when all have heard it, or do not listen. */
  async close () {
    const clients = Object.values(this.listening.clients)
    this.listening.socketServer.close()
    const gone = clients.map(client => once(client, 'end'))
    for (const client of clients) client.end('The run is over')
    await Promise.race([Promise.all(gone), sleep(GOODBYE_MS)])
  }

  /**
   * Say who may come; who is there and may no longer be is sent away, and who looks at something and may come again is told.
   * @returns {string[]} who is there
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

  /** Let time stand still, or go on; people are told. */
  async pause (isPaused) {
    if (!await this.regions.pause(isPaused)) return
    for (const { player } of this.present.values()) player.system(isPaused ? 'Time stands still.' : 'Time goes on.')
    if (isPaused) this.standstill.isOn = true
    else for (const end of this.standstill.end()) if (this.present.get(end.username)?.player._client === end) this.greet(end.release())
  }

  /** Let somebody in as the agent that they are, or else to look; to whom neither is open it says why, or what is given. */
  greet (client, parting) {
    this.inTurn(() => {
      if (client.ended) return
      const refusal = this.refusal(client.username)
      if (refusal === null) this.letIn(client)
      else if (this.mayVisit(client.username)) this.visit(client, this.gallery.entrance)
      else client.end(parting ?? refusal)
    })
  }

  /** Whether somebody who is no agent can come and look: at what is embodied, if anything is. */
  mayVisit (name) {
    const { open } = this.regions
    return open !== null && !open.bodies.has(name) && this.gallery.exhibits.size > 0
  }

  /** The connection of a person who is an agent now; null if a bot is. */
  endOf ({ agent, _client: end }) {
    return this.present.get(agent)?.player._client === end ? end : null
  }

  /**
   * Take a person, an agent or a visitor, to where `/tp X Y Z` says, if they may go there.
   * @returns {boolean} true if it is that command
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

  /** As the agent that they are, or else to look at it. */
  goToReality (client, place) {
    this.inTurn(() => {
      if (client.ended) return
      const exhibit = this.gallery.at(place)
      if (this.refusal(client.username) === null) this.letIn(client)
      else if (exhibit === null) client.end(NO_LONGER_SHOWN)
      else this.visit(client, { exhibit, place })
    })
  }

  /** Somebody who visits can be their agent again: at once if they look at reality, else by its line. */
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

  /** What is no longer shown nobody looks at: agents come back to where they stand, visitors have to go. */
  closeExhibit (name) {
    for (const { end } of this.gallery.close(name)) this.greet(end.release(), NO_LONGER_SHOWN)
  }

  /** @returns {string | null} why somebody cannot come in, as a sentence for them */
  refusal (name) {
    const { open } = this.regions
    const free = [...this.invited].filter(agent => !this.present.has(agent))
    const look = this.gallery.exhibits.size > 0 && open?.bodies.has(name) ? ', or by another name to look' : ''
    const who = `${free.length === 0 ? 'nobody else is awaited now' : `come as ${free.join(' or ')}`}${look}`
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

  /** Who has come to stand after walking has moved there, as one whom a program lets walk. */
  watch (region) {
    for (const standing of this.present.values()) {
      const { player, place } = standing
      if (place === null || !place.equals(player.position)) Object.assign(standing, { place: player.position.clone(), ticks: 0 })
      else if (++standing.ticks === STANDING_TICKS) player.report({ kind: 'move_to', detail: { destination: region.toScenario(player.position.floored()) } })
    }
  }
}

/** Say so to a game of another version than ours; who only asks who is here gets an answer all the same. */
function refuseVersion (client, asked, { version, minecraftVersion }) {
  if (asked.protocolVersion === version || asked.nextState !== LOGIN) return
  // The library answers of its own, and then lets in who does not leave by itself: it is to hear neither of the version nor of the login.
  asked.protocolVersion = version
  client.removeAllListeners('login_start')
  setImmediate(() => client.end(`This is Minecraft ${minecraftVersion}; start the game in that version`))
}

/** Tell a person who is an agent from now on who else is there. */
function equip (end, region) {
  ease(end, end.player.id)
  const others = [...region.bodies.keys()].filter(agent => agent !== end.username).sort()
  end.player.system(`You are ${end.username}. ${others.length > 0 ? `Here are ${others.join(', ')}. ` : ''}What you do and say is recorded.`)
}

/** As the game does: whole numbers are the middle of a block. */
function centred ({ x, y, z }) {
  const middle = value => Number.isInteger(value) ? value + 0.5 : value
  return { x: middle(x), y, z: middle(z) }
}

function greeting ({ name }) {
  const what = name === REALITY ? 'the real world' : `${name}: what ${name.slice(1).split('/').join(' believes that ')} believes`
  return `You look at ${what}. Nobody sees or hears you, and nothing can be changed.`
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

function isDirection ({ yaw, pitch }) {
  return [yaw, pitch].every(Number.isFinite)
}

module.exports = { Door }
