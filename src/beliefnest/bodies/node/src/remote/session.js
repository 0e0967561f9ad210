'use strict'
/** Begins a session on a server elsewhere: looks whether it can be played on, and lets the operator in. */
const minecraft = require('minecraft-protocol')
const { OFFLINE, withAccount } = require('./accounts')
const { USEFUL } = require('./commands')
const { connect } = require('./connection')
const { Link } = require('./link')
const { Operator } = require('./operator')
const { ServerClock } = require('./serverClock')
const reasons = require('./reasons')
const { answersCompletions, ByWaiting } = require('./settling')
const ours = require('../versions')
const { held, heldFor, registryOf } = require('./versions')


/**
 * @param {object} server as RemoteRegions has it; `version` if the server is not to be asked for it
 * @param {(text: string) => void} [tell] shows something to the user
 * @returns {Promise<{operator: Operator, clock: ServerClock, version: string, theirs: object}>} the server's version and registry
 *   besides
 * @throws {Unplayable} with what is missing and what to do
 */
async function beginSession (server, tell = () => {}) {
  server.agents = []
  server.loginOf = player => server.accounts === null ? OFFLINE : withAccount(server.accounts, player, tell)
  const version = await versionOf(server)
  const theirs = registryOf(version)
  const { host, port, operator: username, at: [x, z] } = server
  const link = new Link(username, () => connect({ host, port, version, username, origin: { x, z }, login: server.loginOf(username) }), server, server.patience * 1000)
  const clock = new ServerClock()
  link.on('begun', bot => bot.on('time', () => clock.tell(bot.time.age)))
  const operator = new Operator(link, server, clock)
  await link.open()
  try {
    await operator.attended(() => look(operator, tell))
  } catch (error) {
    await link.close()
    throw error
  }
  return { operator, clock, version, theirs }
}

/** Look whether the operator can do what is needed, and tells what is lacking besides. @throws {Unplayable} if it cannot */
async function look (operator, tell) {
  const { clock, server } = operator
  await operator.until(() => clock.isSet)
  await operator.requireRights(tell)
  const lacking = Object.entries(USEFUL).filter(([name]) => !operator.can(name))
  if (lacking.length > 0) tell(reasons.lesser(server, lacking))
  const answers = await answersCompletions(operator)
  if (answers || !operator.link.isHere) return
  operator.settling = new ByWaiting(clock)
  tell(reasons.noCompletions(server))
}

/** @returns {Promise<string>} the version held that the server speaks, as the address or its answer to a ping says */
async function versionOf (server) {
  const { host, port, version } = server
  const spoken = version === null ? await pinged(server, { host, port }) : { name: version, key: version }
  const found = heldFor(spoken.key)
  if (found === null) throw version === null ? reasons.wrongVersion(server, spoken.name, held()) : reasons.notHeld(server, held())
  return found
}

async function pinged (server, where) {
  const { version: { name, protocol } } = await minecraft.ping({ ...where, version: ours.minecraft, closeTimeout: server.patience * 1000, noPongTimeout: 500 })
    .catch(error => { throw reasons.unreachable(server, error.code ?? error.message) })
  return { name, key: protocol }
}

module.exports = { beginSession }
