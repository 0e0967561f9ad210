'use strict'
/**
 * Login with Microsoft accounts, for servers in online mode, by Mineflayer's own login (prismarine-auth).
 * prismarine-auth keeps the tokens in the user's folder; no message contains any of them.
 */

// Any text that may be a token.
const SECRET = /[\w.~+/=|%-]{32,}/g

/** Options of minecraft-protocol for a player without an account. */
const OFFLINE = { auth: 'offline' }

/**
 * Return the options of minecraft-protocol for a player with an account.
 * @param {string} folder folder of the tokens
 * @param {string} player name of the account, and of the player in the game
 * @param {(text: string) => void} tell shows the user where to log in, and with which code
 * @returns {object}
 */
function withAccount (folder, player, tell) {
  return {
    auth: 'microsoft',
    profilesFolder: folder,
    disableChatSigning: true,
    onMsaCode: ({ verification_uri: page, user_code: code }) => tell(`log in as ${player}: open ${page} and enter the code ${code}`)
  }
}

/** Fail the login of a client if its account belongs to another player. */
function requireName (client, player) {
  client.once('session', ({ selectedProfile: { name } }) => {
    if (name === player) return
    throw new Error(`the account that was logged in for ${player} is called ${name} in the game: give the agent that name, or the operator by ?operator=${name}`)
  })
}

/** Return a text without anything that may be a token. @returns {string} */
const withoutSecrets = text => String(text).replace(SECRET, '...')

module.exports = { OFFLINE, requireName, withAccount, withoutSecrets }
