'use strict'
/** Exhibits on a remote server. */
const { BadRequest } = require('../channel/errors')
const { RemoteExhibit } = require('./remoteExhibit')

const LONGEST_NAME = 16

class RemoteExhibits {
  /** @param {import('./remoteRegions').RemoteRegions} regions */
  constructor (regions) {
    this.regions = regions
    this.byName = new Map()
  }

  async open (description) {
    if (this.regions.server.accounts !== null) {
      throw new BadRequest('beliefs cannot be visited on a server in online mode: everybody shown there would need an account; play on one in offline mode, or in the embedded world with realtime=True')
    }
    if (this.byName.has(description.exhibit)) throw new BadRequest(`${description.exhibit} is shown already; close it first`)
    const exhibit = new RemoteExhibit(description, this.guideName(), this.regions)
    try {
      await this.regions.operator.attended(() => exhibit.build())
    } catch (error) {
      await exhibit.close()
      throw error
    }
    this.byName.set(description.exhibit, exhibit)
    return null
  }

  /** Return a free player name that begins with the operator's. */
  guideName () {
    const { unseen, server, operator: { bot } } = this.regions
    for (let number = 1; ; number++) {
      const end = `_${number}`
      const name = `${server.operator.slice(0, LONGEST_NAME - end.length)}${end}`
      if (unseen.has(name) || bot.players[name] !== undefined) continue
      unseen.add(name)
      return name
    }
  }

  show (message, now) {
    this.byName.get(message.exhibit)?.show(message, now)
  }

  lags () {
    return Object.fromEntries([...this.byName].map(([name, { exhibit }]) => [name, exhibit.lag]))
  }

  async close (name) {
    const exhibit = this.byName.get(name)
    if (exhibit === undefined) throw new BadRequest(`${name} is not shown`)
    this.byName.delete(name)
    await exhibit.close()
    return null
  }

  async closeAll () {
    for (const name of [...this.byName.keys()]) await this.close(name)
  }
}

module.exports = { RemoteExhibits }
