'use strict'
/** The server's end of a connection over TCP, as `serv.join` takes it (see transport.js). */
const { End, handOver } = require('./end')

class TcpEnd extends End {
  /**
   * @param {import('minecraft-protocol').Client} client that has reached the `play` state
   * @param {(action: () => any) => any} inside runs an action in the region of the player
   * @param {(error: Error) => void} report hears what a packet's handlers throw
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

  /** End, and leaves the client connected for another end. @returns {import('minecraft-protocol').Client} */
  release () {
    for (const [event, listener] of Object.entries(this.heard)) this.client.off(event, listener)
    this.isReleased = true
    // Until somebody else listens; an error that nobody hears would end the process.
    this.client.on('error', () => {})
    this.emit('end', 'released')
    return this.client
  }
}

module.exports = { TcpEnd }
