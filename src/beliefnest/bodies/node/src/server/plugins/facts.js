'use strict'

const { EventEmitter } = require('events')

/**
 * Facts only the server can know: who opened, took, stored, mined, placed or switched
 * what. Each is emitted on `serv.facts` as `event` with
 * `{kind, actor, player, detail}`; positions in `detail` are `[x, y, z]` of the server's world.
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
