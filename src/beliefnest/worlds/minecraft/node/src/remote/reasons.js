'use strict'
/** Reasons why a server cannot be played on, in words for its user: what was found, and what to type. */

const { withoutSecrets } = require('./accounts')

class Unplayable extends Error {
  /** Kind of the failure for the channel: the world failed, and the message says everything. */
  get kind () { return 'world' }
}

const where = ({ host, port }) => `the server at ${host}:${port}`

/** Texts for the game's own refusals, by the key of the game's text. */
const REFUSALS = {
  'multiplayer.disconnect.server_full': ({ agents }) =>
    `is full: it has no room for the ${agents.length} agents and the operator; raise max-players in server.properties and restart it`,
  'multiplayer.disconnect.not_whitelisted': ({ agents, operator }) =>
    `lets in only the players on its whitelist; on its console: ${[operator, ...agents].map(name => `whitelist add ${name}`).join(', ')}`,
  'multiplayer.disconnect.unverified_username': () =>
    'asks Microsoft who players are (online mode); set online-mode=false in server.properties and restart it, or log in with ' +
    'accounts: ?accounts=FOLDER',
  'multiplayer.disconnect.duplicate_login': () =>
    'has disconnected a player because another one with the same name joined; end the other run, or give the agents other names',
  'multiplayer.disconnect.name_taken': () => 'already has a player of that name; end the other run, or give agents other names'
}

/**
 * Return the error for a refused player.
 * @param {{host: string, port: number, operator: string, agents: string[]}} server
 * @param {string} player name of the refused player
 * @param {{key?: string, text: string}} told the server's reason
 */
function refusal (server, player, { key, text }) {
  const refusal = REFUSALS[key]
  if (refusal !== undefined) return new Unplayable(`${where(server)} ${refusal(server)}`)
  return new Unplayable(`${where(server)} does not let ${player} in: ${text}`)
}

const unreachable = (server, why) => new Unplayable(
  `${where(server)} does not answer (${why}); start it, or correct the address: minecraft://HOST:PORT`)

const noLogin = (server, player, why) => new Unplayable(
  `${player} cannot log in to ${where(server)}: ${withoutSecrets(why)}`)

const onlineMode = server => refusal(server, '', { key: 'multiplayer.disconnect.unverified_username', text: '' })

const wrongVersion = (server, spoken, versions) => new Unplayable(
  `${where(server)} speaks Minecraft ${spoken}; this installation has the data of ${versions.join(', ')}. Run a server of one ` +
  'of these, or install further versions (docs/servers.md: pip install ./packages/versions); a server that accepts several versions, or reports a wrong one, is ' +
  `played on with ?version=${versions[0]}`)

const notHeld = ({ version }, versions) => new Unplayable(
  `?version=${version} asks for a version of Minecraft whose data this installation does not have; it has the data of ${versions.join(', ')}, ` +
  'and further versions can be installed (docs/servers.md: pip install ./packages/versions)')

const noOperator = (server, lacking) => new Unplayable(
  `on ${where(server)} ${server.operator} may not use ${lacking.map(name => `/${name}`).join(', ')}; on its console: op ${server.operator}. ` +
  'If it is an operator already, the server has no such commands and cannot be used')

const noCommands = server => new Unplayable(
  `${where(server)} does not list its commands, as a vanilla server does; without /fill, /setblock and others it cannot be used`)


/** Return a warning about a usable server that lacks optional commands. */
const lesser = (server, lacking) =>
  `${where(server)} does not let ${server.operator} use ${lacking.map(([name, without]) => `/${name} (${without})`).join(', ')}`

const noCompletions = server =>
  `${where(server)} does not answer requests for completions of commands, as vanilla servers do. Commands are typed one by one, with a wait of 3 ticks where the answer would show ` +
  'that all commands are done; later effects are recorded later'

const waitingForCommands = (server, lacking) =>
  `${where(server)} does not let ${server.operator} use ${lacking.map(name => `/${name}`).join(', ')} yet; waiting up to ${server.patience} s for it. ` +
  `On its console: op ${server.operator}`

/** Advice for the time after an interruption. */
const GO_ON = 'the record up to the last call is kept: when the server runs again, continue with the same command and --out, or with Nest.resume'

const cutOff = (server, player, why) => new Unplayable(
  `the connection of ${player} to ${where(server)} was lost (${why}) before everything was set up there; check that the server runs, and run the command again`)

const left = (server, player) => new Unplayable(`${player} has left ${where(server)}`)

const tooFar = (server, { low, high }) => new Unplayable(
  `${where(server)} does not send the whole box from (${low.join(', ')}) to (${high.join(', ')}); raise view-distance in server.properties and restart it`)

const spawnProtected = server => new Unplayable(
  `on ${where(server)} agents cannot use blocks where the box is; set spawn-protection=0 in server.properties and restart it, ` +
  'or play farther from its spawn: ?at=X,Z (multiples of 16)')

const stalled = (server, seconds) => new Unplayable(
  `${where(server)} has not answered for ${seconds} s; ${GO_ON}`)

const gone = (server, player, why, seconds) => new Unplayable(
  `the connection of ${player} to ${where(server)} was lost (${why}) and did not come back within ${seconds} s; ` +
  GO_ON)

module.exports = { cutOff, gone, left, lesser, noCommands, noCompletions, noLogin, noOperator, notHeld, onlineMode, refusal, spawnProtected, stalled, tooFar, unreachable, Unplayable, waitingForCommands, wrongVersion }
