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
    client.on('packet', (params, { name, state }) => {
      if (state === 'play') inside(() => this.deliver(name, params))
    })
    client.on('error', error => { if (!client.ended) report(error) })
    client.on('end', reason => inside(() => this.emit('end', reason)))
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
    if (!this.client.ended) this.client.write(name, params)
  }

  end (reason) {
    if (!this.client.ended) this.client.end(reason)
  }
}

module.exports = { TcpEnd }
