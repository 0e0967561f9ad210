'use strict'

const { EventEmitter } = require('events')

/**
 * Add `serv.facts`: facts that only the server knows, such as who opened, took, stored, mined, placed or switched
 * something. Each is emitted as `event` with `{kind, actor, player, detail}`; positions in `detail` are `[x, y, z]` of
 * the server's world.
 */
module.exports.server = (serv) => {
  serv.facts = new EventEmitter()
  serv.emitEvent = (event) => { serv.facts.emit('event', event) }
}

module.exports.player = (player, serv) => {
  player.emitEvent = ({ kind, detail }) => {
    serv.emitEvent({ kind, actor: player.username, player, detail })
  }
}
