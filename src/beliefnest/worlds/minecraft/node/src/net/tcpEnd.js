'use strict'
/** Server's end of a TCP connection, in the form that `serv.join` takes (see transport.js). */
const { End, handOver } = require('./end')

class TcpEnd extends End {
  /**
   * @param {import('minecraft-protocol').Client} client client that has reached the `play` state
   * @param {(action: () => any) => any} inside runs an action in the region of the player
   * @param {(error: Error) => void} report called with errors of a packet's handlers
   */
  constructor (client, inside, report) {
    super(client.username, client.uuid)
    this.client = client
    this.report = report
    this.isReleased = false
    this.heard = {
      packet: (params, { name, state }) => { if (state === 'play') inside(() => this.deliver(name, params)) },
      error: error => { if (!client.ended) report(error) },
      end: reason => inside(() => this.emit('end', reason))
    }
    for (const [event, listener] of Object.entries(this.heard)) client.on(event, listener)
  }

  supportFeature (feature) {
    return this.client.supportFeature(feature)
  }

  deliver (name, params) {
    try {
      handOver(this, name, params, this.report)
    } catch (error) {
      this.report(error)
    }
  }

  write (name, params) {
    if (!this.client.ended && !this.isReleased) this.client.write(name, params)
  }

  end (reason) {
    if (!this.client.ended && !this.isReleased) this.client.end(reason)
  }

  /** End this end, but keep the client connected for another one. @returns {import('minecraft-protocol').Client} */
  release () {
    for (const [event, listener] of Object.entries(this.heard)) this.client.off(event, listener)
    this.isReleased = true
    // Until another end listens; Node ends the process on an error that has no listener.
    this.client.on('error', () => {})
    this.emit('end', 'released')
    return this.client
  }
}

module.exports = { TcpEnd }
