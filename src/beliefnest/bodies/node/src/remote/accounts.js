'use strict'
/**
 * Logging in with Microsoft accounts, for servers in online mode, by Mineflayer's own login (prismarine-auth). Its
 * tokens are kept in the user's folder, by prismarine-auth; nothing of them is told anywhere.
 */

// What may be a token, wherever it comes from.
const SECRET = /[\w.~+/=|%-]{32,}/g

/** Options of minecraft-protocol for a player without an account. */
const OFFLINE = { auth: 'offline' }

/**
 * @param {string} folder where tokens are kept
 * @param {string} player whose account it is; also its name in the game
 * @param {(text: string) => void} tell shows the user where to log in, with which code
 * @returns {object} options of minecraft-protocol
 */
function withAccount (folder, player, tell) {
  return {
    auth: 'microsoft',
    profilesFolder: folder,
    disableChatSigning: true,
    onMsaCode: ({ verification_uri: page, user_code: code }) => tell(`log in as ${player}: open ${page} and enter the code ${code}`)
  }
}

/** Keep a client from connecting with another player's account than the one it is for: the login fails. */
function requireName (client, player) {
  client.once('session', ({ selectedProfile: { name } }) => {
    if (name === player) return
    throw new Error(`the account that was logged in for ${player} is called ${name} in the game: call the agent so, or the operator by ?operator=${name}`)
  })
}

/** @returns {string} a text without what may be a token */
const withoutSecrets = text => String(text).replace(SECRET, '...')

module.exports = { OFFLINE, requireName, withAccount, withoutSecrets }
