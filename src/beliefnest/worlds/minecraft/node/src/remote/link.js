'use strict'
/** Connection of one player to a server. A lost connection is opened again, after growing pauses. */
const { EventEmitter, once } = require('node:events')
const { setTimeout: sleep } = require('node:timers/promises')
const { REAL_TIME, startBot } = require('../bots/bot')
const reasons = require('./reasons')

const FIRST_PAUSE_MS = 250
const POLL_MS = 20
const LONGEST_PAUSE_MS = 8000
// Lifetime of a login code.
const ACCOUNT_MS = 900_000
const GOODBYE_MS = 1000
// Message of the game to a player when another one with the same name joins.
const ANOTHER = 'multiplayer.disconnect.duplicate_login'

class Link extends EventEmitter {
  /**
   * @param {string} name name of the player
   * @param {() => object} connect begins a connection (connection.js)
   * @param {object} server server, as in reasons.js
   * @param {number} patienceMs time after which a lost connection is given up
   * @param {(link: Link) => Promise<void>} [arrive] called whenever the player has joined
   */
  constructor (name, connect, server, patienceMs, arrive = async () => {}) {
    super()
    this.name = name
    this.connect = connect
    this.server = server
    this.patienceMs = patienceMs
    this.arrive = arrive
    this.bot = null
    // isHere: connected; isReady: connected, and `arrive` has ended.
    this.isHere = false
    this.isReady = false
    this.failure = null
    this.closed = false
    // isForPerson: a person may join under this name; isYielded: a person has joined and plays.
    this.isForPerson = false
    this.isYielded = false
  }

  /** Connect for the first time. @throws {Unplayable} if the server does not let the player in */
  async open () {
    const client = this.connect()
    const bot = startBot(client, REAL_TIME)
    this.emit('begun', bot, client)
    bot.physicsEnabled = false
    // Waiting code has listeners of its own; Node ends the process on an error without a listener.
    bot.on('error', () => {})
    let kick = null
    const ended = reason => this.lost(kick?.text ?? reason, kick?.key)
    try {
      await this.spawned(bot, client)
      // The connection may have ended during the steps above.
      if (client.ended) throw reasons.unreachable(this.server, 'it ended the connection')
      this.bot = bot
      this.isHere = true
      bot.once('end', ended)
      bot.on('kicked', reason => { kick = reasonOf(bot, reason) })
      await this.arrive(this)
      this.isReady = this.isHere
    } catch (error) {
      this.isHere = false
      // The caller of `open` receives the error itself.
      bot.off('end', ended)
      client.end('given up')
      throw error
    }
  }

  async spawned (bot, client) {
    const ending = new AbortController()
    const { signal } = ending
    const { promise: late, reject } = Promise.withResolvers()
    const failed = (event, make) => once(client, event, { signal }).then(args => { throw make(...args) })
    const wait = this.server.accounts === null ? this.server.patience * 1000 : ACCOUNT_MS
    const timer = setTimeout(() => reject(reasons.unreachable(this.server, `${wait / 1000} s passed before it let ${this.name} in`)), wait)
    const refused = packet => reasons.refusal(this.server, this.name, reasonOf(bot, packet.reason))
    const waiting = [
      once(bot, 'spawn', { signal }),
      ...this.server.accounts === null ? [failed('encryption_begin', () => reasons.onlineMode(this.server))] : [],
      failed('disconnect', refused),
      failed('kick_disconnect', refused),
      failed('end', reason => reasons.unreachable(this.server, `it ended the connection: ${reason}`))
    ]
    try {
      await Promise.race([late, ...waiting])
    } catch (error) {
      // Whatever the wait was for, an error of the connection ends it.
      throw error instanceof reasons.Unplayable ? error : this.broken(error)
    } finally {
      clearTimeout(timer)
      ending.abort()
      await Promise.allSettled(waiting)
    }
  }

  /** Return the reason for a connection error before the player has joined. @returns {Unplayable} */
  broken ({ code, message }) {
    return this.server.accounts === null || code !== undefined
      ? reasons.unreachable(this.server, code ?? message)
      : reasons.noLogin(this.server, this.name, message)
  }

  lost (reason, key) {
    this.isHere = this.isReady = false
    if (this.closed) return
    if (key === ANOTHER && this.isForPerson) {
      this.yield()
      return
    }
    this.emit('lost', reason)
    this.reconnect(reason)
  }

  /** Let a person play under this name. */
  yield () {
    this.isYielded = true
    this.emit('yielded')
  }

  /** Join again, after a person has played under this name. */
  takeBack () {
    if (!this.isYielded || this.closed) return
    this.isYielded = false
    this.reconnect('the person left')
  }

  reconnect (reason) {
    this.again(reason).catch(error => {
      this.failure = error
      this.emit('failed', error)
    })
  }

  async again (reason) {
    const end = performance.now() + this.patienceMs
    for (let pause = FIRST_PAUSE_MS; !this.closed; pause = Math.min(2 * pause, LONGEST_PAUSE_MS)) {
      await sleep(Math.min(pause, Math.max(0, end - performance.now())))
      if (this.closed) return
      try {
        await this.open()
        this.emit('back')
        return
      } catch (error) {
        if (performance.now() >= end) throw reasons.gone(this.server, this.name, `${reason}; then: ${error.message}`, this.patienceMs / 1000)
      }
    }
  }

  /**
   * Resolve when the player has connected and arrived, or a person plays it.
   * @throws {Unplayable} if it was given up
   */
  async present () {
    while (!this.isReady && !(this.isYielded && this.isForPerson)) {
      if (this.failure !== null) throw this.failure
      await sleep(POLL_MS)
    }
  }

  async close () {
    this.closed = true
    if (!this.isHere) return
    const { _client: client } = this.bot
    const ended = once(this.bot, 'end')
    client.end('the world is given up')
    // A server that hangs does not close the connection.
    const late = setTimeout(() => client.socket.destroy(), GOODBYE_MS)
    await ended
    clearTimeout(late)
  }
}

/** Return a server's reason for a disconnection: its text, and the key of the game's own text. */
function reasonOf (bot, reason) {
  const ChatMessage = require('prismarine-chat')(bot.registry)
  const message = ChatMessage.fromNotch(reason)
  return { key: message.translate ?? message.json?.translate, text: message.toString() }
}

module.exports = { Link }
