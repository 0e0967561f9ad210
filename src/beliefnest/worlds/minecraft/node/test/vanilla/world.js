'use strict'
/**
 * One open world without regions, as on any server: a floor of stone under air, players who join where they left,
 * operators, and a time of day. Players come over TCP.
 */
const nbt = require('prismarine-nbt')
const { Box } = require('../../src/regions/box')
const { join, showWorld } = require('../../src/regions/joining')
const { columnsOf } = require('../../src/regions/ground')
const { Region, TICK_MS } = require('../../src/regions/region')
const { TcpEnd } = require('../../src/net/tcpEnd')
const { COMMANDS, runCommand } = require('./commands')

const BOX = [[-64, -63, -64], [63, 60, 63]]
const FLOOR_Y = -61
const SPAWN = [0.5, FLOOR_Y + 1, 0.5]
const AGE_EVERY = 20
const CRAFTER = 7
// View distance in chunks.
const VIEW = 8
const NEWCOMER = { position: SPAWN, yaw: 0, pitch: 0, on_ground: true, health: 20, food: 20, gameMode: 0 }
// Errors of connections whose client left without waiting for the packets on their way.
const BROKEN_OFF = ['EPIPE', 'ECONNRESET']
const ALL_MAY = ['tell', 'msg', 'w']

/** Disconnect a player for a reason that the client has in words; `reason` ends its key. */
function sendAway ({ _client: { client } }, reason) {
  const translate = `multiplayer.disconnect.${reason}`
  client.end(reason, client._supportFeature('chatPacketsUseNbtComponents') ? nbt.comp({ translate: nbt.string(translate) }) : JSON.stringify({ translate }))
}

class OpenWorld {
  /**
   * @param {object} serv server from createServer
   * @param {object} options
   * @param {string[]} options.ops names of the operators
   * @param {number} options.age age in ticks
   * @param {number} options.diesAt number of the players' packet that ends the process
   * @param {number} options.commandsLate ticks after which operators receive their own commands
   */
  constructor (serv, { ops, age, diesAt, commandsLate }) {
    this.serv = serv
    this.packets = { heard: 0, diesAt }
    this.commandsLate = commandsLate
    this.ops = new Set(ops)
    // Settings of the console: missing commands (or `completions`), whether only operators may use blocks, how many
    // players may join, and who is to be verified.
    this.lacking = new Set()
    this.isProtected = false
    this.room = Infinity
    this.verified = {}
    // Console lines that are typed at a later tick.
    this.later = []
    this.statesByName = new Map()
    this.region = openRegion(age)
    serv.region = this.region
    build(serv, this.region)
    this.far = []
    loadFar(serv, this.far)
    serv.command = (player, text) => this.command(player, text)
    const canUse = serv.interact
    serv.interact = use => this.mayUse(use.player) && canUse(use)
  }

  mayUse ({ username }) {
    return !this.isProtected || this.ops.has(username)
  }

  join (client) {
    const { serv, region } = this
    const other = serv.players.find(({ username }) => username === client.username)
    if (other !== undefined) {
      other.once('disconnected', () => this.join(client))
      sendAway(other, 'duplicate_login')
      return
    }
    const state = this.statesByName.get(client.username) ?? NEWCOMER
    const end = new TcpEnd(client, action => action(), error => {
      if (!BROKEN_OFF.includes(error.code)) process.stderr.write(`${client.username}: ${error.stack}\n`)
    })
    if (!serv.registry.supportFeature('chatPacketsUseNbtComponents')) speakOlder(end, serv.registry)
    const player = join(serv, region, end, state)
    player.gameMode = state.gameMode
    showWorld(player, region.columns)
    player.updateHealth(state.health)
    player.knowsCommandsAt = region.tick + this.commandsLate
    this.tellCommands(player)
    if (this.commandsLate > 0) this.later.push({ tick: player.knowsCommandsAt, line: `tell ${player.username}` })
    this.tellAge([player])
    end.on('tab_complete', ({ transactionId }) => {
      if (!this.lacking.has('completions')) end.write('tab_complete', { transactionId, start: 1, length: 0, matches: [] })
    })
    player.on('disconnected', () => this.statesByName.set(player.username, {
      position: region.toScenario(player.position), ...player.pose, on_ground: player.onGround, health: player.health, food: player.food, gameMode: player.gameMode
    }))
  }

  /** Refuse a player if the server is full, as the game does. */
  admit (client) {
    client.on('packet', () => { if (++this.packets.heard === this.packets.diesAt) process.kill(process.pid, 'SIGKILL') })
    if (this.serv.players.length >= this.room) client.end('full', JSON.stringify({ translate: 'multiplayer.disconnect.server_full' }))
  }

  commandsOf ({ username, knowsCommandsAt }) {
    const own = this.ops.has(username) && this.region.tick >= knowsCommandsAt ? Object.keys(COMMANDS) : []
    return [...ALL_MAY, ...own].filter(name => !this.lacking.has(name))
  }

  tellCommands (player) {
    const node = (type, children, name) => ({
      flags: { unused: 0, has_custom_suggestions: 0, has_redirect_node: 0, has_command: 1, command_node_type: type },
      children,
      redirectNode: undefined,
      extraNodeData: name === undefined ? undefined : { name }
    })
    const names = this.commandsOf(player)
    player._client.write('declare_commands', {
      nodes: [node(0, names.map((_, index) => index + 1)), ...names.map(name => node(1, [], name))], rootIndex: 0
    })
  }

  command (player, text) {
    const isCommand = this.commandsOf(player).includes(text.split(' ')[0])
    player.system(isCommand ? runCommand(this.serv, text, player) : 'Unknown or incomplete command, see below for error')
  }

  tellAge (players) {
    const { tick } = this.region
    for (const player of players) player._client.write('update_time', { age: [0, tick], time: [0, 6000] })
  }

  tick () {
    const { serv, region } = this
    region.tick += 1
    serv.tickCount = region.tick
    for (const { line } of this.later.filter(({ tick }) => tick === region.tick)) this.console(line)
    serv.tickRegion(() => true)
    for (const player of serv.players) nearColumns(player, this.far).forEach(column => player.sendColumn(...column))
    serv.emit('tick', TICK_MS / 1000, region.tick, region)
    if (region.tick % AGE_EVERY === 0) this.tellAge(serv.players)
  }

  /** Disconnect everybody and end, as the game does. */
  stop () {
    let here = this.serv.players.length
    if (here === 0) process.exit(0)
    for (const player of [...this.serv.players]) {
      player.once('disconnected', () => { if (--here === 0) process.exit(0) })
      sendAway(player, 'server_shutdown')
    }
  }

  /** Run one line of the console. */
  console (line) {
    const [word, name, ...more] = line.split(' ')
    if (word === 'after') {
      this.later.push({ tick: this.region.tick + Number(name), line: more.join(' ') })
      return
    }
    if (word === 'stall') {
      stall(Number(name))
      return
    }
    if (word === 'stop') {
      this.stop()
      return
    }
    const player = this.serv.players.find(({ username }) => username === name)
    if (word === 'lack') this.lacking = new Set(name ? [name] : [])
    else if (word === 'protect') this.isProtected = name === 'yes'
    else if (word === 'room') this.room = Number(name)
    else if (word === 'verify') this.verified[name.toLowerCase()] = true
    else if (word === 'trust') delete this.verified[name.toLowerCase()]
    else if (word === 'op') this.ops.add(name)
    else if (word === 'deop') this.ops.delete(name)
    else if (word === 'kick') { if (player) sendAway(player, 'kicked') }
    else if (word === 'drop') player?._client.client.socket.destroy()
    else if (player === undefined) runCommand(this.serv, line, null)
    if (player !== undefined && (word.endsWith('op') || word === 'tell')) this.tellCommands(player)
  }
}

/**
 * Send windows in the form before 1.20.3 (titles as JSON, no crafter among the kinds), and logins in the form before
 * 1.20.2 (with all registries).
 */
function speakOlder (end, { loginPacket: { dimensionCodec } }) {
  const { write } = end
  const older = {
    login: params => ({ ...params, dimensionCodec }),
    open_window: ({ inventoryType, windowTitle, ...params }) => ({
      ...params, inventoryType: inventoryType - (inventoryType > CRAFTER), windowTitle: JSON.stringify({ text: windowTitle.value.text.value })
    })
  }
  end.write = (name, params) => write.call(end, name, older[name]?.(params) ?? params)
}

/** Block the process, like a server that is busy with something else. */
function stall (milliseconds) {
  Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, milliseconds)
}

/** Open a region that records nothing. */
function openRegion (age) {
  const region = new Region({ name: 'world', seed: 'world', box: new Box(...BOX), origin: { x: 0, z: 0 }, tick: age, agentNames: [] })
  region.recorder = { event () {}, serverEvent () {}, blockChanged () {} }
  return region
}

/** Set air at force-loaded distant positions, and show it to players who come near. */
function loadFar (serv, columns) {
  const Chunk = require('prismarine-chunk')(serv.registry)
  serv.loadColumns = (x1, z1, x2, z2) => {
    for (let x = x1 >> 4; x <= x2 >> 4; x++) {
      for (let z = z1 >> 4; z <= z2 >> 4; z++) {
        if (serv.overworld.sync.getColumn(x, z)) continue
        serv.overworld.sync.setColumn(x, z, new Chunk({ minY: serv.minY, worldHeight: serv.worldHeight }))
        columns.push([x, z])
      }
    }
  }
}

/** Return the loaded columns near a player who has not received them yet. */
function nearColumns ({ position, loadedChunks }, columns) {
  const [x, z] = [position.x, position.z].map(value => Math.floor(value) >> 4)
  return columns.filter(each => !loadedChunks[each.join()] && Math.max(Math.abs(each[0] - x), Math.abs(each[1] - z)) <= VIEW)
}

function build (serv, region) {
  const Chunk = require('prismarine-chunk')(serv.registry)
  region.columns = columnsOf(new Box([BOX[0][0] + 1, 0, BOX[0][2] + 1], [BOX[1][0] - 1, 0, BOX[1][2] - 1]), region.origin)
  const stone = serv.registry.blocksByName.stone.defaultState
  for (const [x, z] of region.columns) {
    const column = new Chunk({ minY: serv.minY, worldHeight: serv.worldHeight })
    for (let i = 0; i < 256; i++) column.setBlockStateId({ x: i & 15, y: FLOOR_Y, z: i >> 4 }, stone)
    serv.overworld.sync.setColumn(x, z, column)
  }
}

module.exports = { OpenWorld, TICK_MS }
