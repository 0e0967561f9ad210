'use strict'
/** Begins a session on a server elsewhere: looks whether it can be played on, and lets the operator in. */
const minecraft = require('minecraft-protocol')
const { connect } = require('./connection')
const { Link } = require('./link')
const { Operator } = require('./operator')
const { ServerClock } = require('./serverClock')
const reasons = require('./reasons')
const versions = require('../versions')

const PING_MS = 5000

/**
 * @param {object} server as RemoteRegions has it; `version` if the server is not to be asked for it
 * @returns {Promise<{operator: Operator, clock: ServerClock}>}
 * @throws {Unplayable} with what is missing and what to do
 */
async function beginSession (server) {
  server.agents = []
  await requireVersion(server)
  const { host, port, operator: username, at: [x, z] } = server
  const link = new Link(username, () => connect({ host, port, username, origin: { x, z } }), server, server.patience * 1000)
  const clock = new ServerClock()
  link.on('begun', bot => bot.on('time', () => clock.tell(bot.time.age)))
  const operator = new Operator(link, server)
  await link.open()
  try {
    await operator.requireRights()
    if (!await operator.until(() => clock.isSet)) throw reasons.stalled(server, PING_MS / 1000)
  } catch (error) {
    await link.close()
    throw error
  }
  return { operator, clock }
}

async function requireVersion (server) {
  if (server.version !== null) {
    if (server.version !== versions.minecraft) throw reasons.wrongVersion(server, server.version, versions.minecraft)
    return
  }
  const { host, port } = server
  const told = await minecraft.ping({ host, port, version: versions.minecraft, closeTimeout: PING_MS, noPongTimeout: 500 })
    .catch(error => { throw reasons.unreachable(server, error.code ?? error.message) })
  const { version } = require('minecraft-data')(versions.minecraft)
  if (told.version.protocol !== version.version) throw reasons.wrongVersion(server, told.version.name, versions.minecraft)
}

module.exports = { beginSession }
