'use strict'
/** Why a server cannot be played on, in words for the person who runs it: what was found, and what to type. */

const { withoutSecrets } = require('./accounts')

class Unplayable extends Error {
  /** Of the channel: the world failed, and the message is all there is to say. */
  get kind () { return 'world' }
}

const where = ({ host, port }) => `the server at ${host}:${port}`

/** What the game says when it refuses a player, by the key of its text. */
const REFUSALS = {
  'multiplayer.disconnect.server_full': ({ agents }) =>
    `is full: it has no room for the ${agents.length} agents and the operator; raise max-players in server.properties and restart it`,
  'multiplayer.disconnect.not_whitelisted': ({ agents, operator }) =>
    `lets in players of its list only; on its console: ${[operator, ...agents].map(name => `whitelist add ${name}`).join(', ')}`,
  'multiplayer.disconnect.unverified_username': () =>
    'asks Microsoft who players are (online mode); set online-mode=false in server.properties and restart it, or log in with ' +
    'accounts: ?accounts=FOLDER',
  'multiplayer.disconnect.duplicate_login': () =>
    'has sent a player away because another one of the same name came; end the other run, or give agents other names',
  'multiplayer.disconnect.name_taken': () => 'has a player of that name already; end the other run, or give agents other names'
}

/**
 * @param {{host: string, port: number, operator: string, agents: string[]}} server
 * @param {string} player who was refused
 * @param {{key?: string, text: string}} told
 */
function refusal (server, player, { key, text }) {
  const known = REFUSALS[key]
  if (known !== undefined) return new Unplayable(`${where(server)} ${known(server)}`)
  return new Unplayable(`${where(server)} does not let ${player} in: ${text}`)
}

const unreachable = (server, why) => new Unplayable(
  `${where(server)} does not answer (${why}); start it, or mend the address: minecraft://HOST:PORT`)

const noLogin = (server, player, why) => new Unplayable(
  `${player} cannot log in to ${where(server)}: ${withoutSecrets(why)}`)

const onlineMode = server => refusal(server, '', { key: 'multiplayer.disconnect.unverified_username', text: '' })

const wrongVersion = (server, found, held) => new Unplayable(
  `${where(server)} speaks Minecraft ${found}; this installation has what is needed for ${held.join(', ')}. Run a server of one ` +
  'of these, or install further versions (docs/servers.md: pip install ./packages/versions); one that speaks several, or lies about it, is ' +
  `played on with ?version=${held[0]}`)

const notHeld = ({ version }, held) => new Unplayable(
  `?version=${version} asks for a Minecraft of which this installation does not have what is needed; it has that for ${held.join(', ')}, ` +
  'and further versions can be installed (docs/servers.md: pip install ./packages/versions)')

const noOperator = (server, lacking) => new Unplayable(
  `on ${where(server)} ${server.operator} may not use ${lacking.map(name => `/${name}`).join(', ')}; on its console: op ${server.operator}. ` +
  'If it is an operator already, the server has no such commands, and cannot be played on')

const noCommands = server => new Unplayable(
  `${where(server)} does not tell which commands there are, as the game's own does; without /fill, /setblock and others it cannot be played on`)


/** What is said of a server that can be played on, and lacks something. */
const lesser = (server, lacking) =>
  `${where(server)} lets ${server.operator} not use ${lacking.map(([name, without]) => `/${name} (${without})`).join(', ')}`

const noCompletions = server =>
  `${where(server)} does not answer requests for completions of commands, as vanilla ones do; commands are typed singly, and 3 ticks waited for where its answer would say ` +
  'that all is done: what comes later is told later'

const waitingForCommands = (server, lacking) =>
  `${where(server)} does not let ${server.operator} use ${lacking.map(name => `/${name}`).join(', ')} yet; this is waited for during ${server.patience} s. ` +
  `On its console: op ${server.operator}`

/** What is done when a server runs again. */
const GO_ON = 'what was recorded until the last call is kept: when the server runs again, go on with the same command and --out, or with Nest.resume'

const cutOff = (server, player, why) => new Unplayable(
  `the connection of ${player} to ${where(server)} was lost (${why}) before everything was set up there; look whether the server runs, and run the command again`)

const left = (server, player) => new Unplayable(`${player} has left ${where(server)}`)

const tooFar = (server, { low, high }) => new Unplayable(
  `${where(server)} does not show all of the box from (${low.join(', ')}) to (${high.join(', ')}); raise view-distance in server.properties and restart it`)

const spawnProtected = server => new Unplayable(
  `on ${where(server)} agents cannot use blocks where the box is; set spawn-protection=0 in server.properties and restart it, ` +
  'or play farther from its spawn: ?at=X,Z (multiples of 16)')

const stalled = (server, seconds) => new Unplayable(
  `${where(server)} has not gone on for ${seconds} s; ${GO_ON}`)

const gone = (server, player, why, seconds) => new Unplayable(
  `the connection of ${player} to ${where(server)} was lost (${why}) and did not come back within ${seconds} s; ` +
  GO_ON)

module.exports = { cutOff, gone, left, lesser, noCommands, noCompletions, noLogin, noOperator, notHeld, onlineMode, refusal, spawnProtected, stalled, tooFar, unreachable, Unplayable, waitingForCommands, wrongVersion }
