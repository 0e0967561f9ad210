'use strict'
/** Start of a session on a remote server: it checks that the server can be used, and lets the operator in. */
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
const { installedVersions, heldFor, registryOf } = require('./versions')


/**
 * Begin a session.
 * @param {object} server server, as in RemoteRegions; with `version` the server is not asked for its version
 * @param {(text: string) => void} [tell] shows a text to the user
 * @returns {Promise<{operator: Operator, clock: ServerClock, version: string, theirs: object}>} the operator, and the
 *   server's version and registry
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

/**
 * Check the operator's rights; warn the user about missing optional ones.
 * @throws {Unplayable} if a required one is missing
 */
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

/**
 * Return the held version that the server speaks, according to its address or its answer to a ping.
 * @returns {Promise<string>}
 */
async function versionOf (server) {
  const { host, port, version } = server
  const spoken = version === null ? await pinged(server, { host, port }) : { name: version, key: version }
  const installed = heldFor(spoken.key)
  if (installed === null) throw version === null ? reasons.wrongVersion(server, spoken.name, installedVersions()) : reasons.notHeld(server, installedVersions())
  return installed
}

async function pinged (server, where) {
  const { version: { name, protocol } } = await minecraft.ping({ ...where, version: ours.minecraft, closeTimeout: server.patience * 1000, noPongTimeout: 500 })
    .catch(error => { throw reasons.unreachable(server, error.code ?? error.message) })
  return { name, key: protocol }
}

module.exports = { beginSession }
