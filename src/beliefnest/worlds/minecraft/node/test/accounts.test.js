'use strict'
const assert = require('node:assert/strict')
const { once } = require('node:events')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')
const { afterEach, beforeEach, test } = require('node:test')

// Answers to requests to Microsoft and Mojang: no request leaves this process.
let answers = {}
const asked = []
async function answer (url, { body = '' } = {}) {
  const part = Object.keys(answers).find(part => String(url).includes(part))
  asked.push({ url: String(url), body: String(body) })
  if (part === undefined) throw new Error(`nobody answers ${url}`)
  const text = JSON.stringify(answers[part])
  return { ok: true, status: 200, statusText: 'OK', headers: new Map(), text: async () => text, json: async () => JSON.parse(text) }
}
globalThis.fetch = answer
require.cache[require.resolve('node-fetch')] = { id: 'node-fetch', loaded: true, exports: answer }

const minecraft = require('minecraft-protocol')
const { withAccount, withoutSecrets } = require('../src/remote/accounts')
const { connect } = require('../src/remote/connection')
const versions = require('../src/versions')

const TOKEN = 'EwBoA8l6BAAUSECRETSECRETSECRETSECRETSECRETSECRET'
const LATER = '2126-01-01T00:00:00Z'
const xbox = { Token: TOKEN, NotAfter: LATER, IssueInstant: LATER, DisplayClaims: { xui: [{ uhs: 'hash', xid: '1' }], xdi: {}, xti: {} } }
const profile = name => ({ id: '069a79f444e94726a5befca90e38aaf5', name })

let folder, server
beforeEach(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'accounts-'))
  answers = {
    'oauth20_connect.srf': { user_code: 'ABCD-EFGH', device_code: 'device', verification_uri: 'https://example.org/link', interval: 0.01, expires_in: 900 },
    'oauth20_token.srf': { access_token: TOKEN, refresh_token: TOKEN, expires_in: 3600, token_type: 'bearer' },
    'xboxlive.com': xbox,
    login_with_xbox: { access_token: TOKEN, expires_in: 86400, username: 'u' },
    'minecraft/profile': profile('sally'),
    'session/minecraft/join': '',
    'session/minecraft/hasJoined': { ...profile('sally'), properties: [] }
  }
  asked.length = 0
  server = minecraft.createServer({ host: '127.0.0.1', port: 0, version: versions.minecraft, 'online-mode': true, hideErrors: true })
  await once(server, 'listening')
})
afterEach(async () => {
  server.close()
  await once(server, 'close')
  fs.rmSync(folder, { recursive: true })
})

const joining = lines => connect({
  port: server.socketServer.address().port, version: versions.minecraft, username: 'sally', origin: { x: 0, z: 0 }, login: withAccount(folder, 'sally', text => lines.push(text))
})

test('a player logs in with a code that the user is shown, once', async () => {
  const lines = []
  for (let time = 0; time < 2; time++) {
    const client = joining(lines)
    const [there] = await once(server, 'playerJoin')
    assert.equal(there.username, 'sally')
    assert.ok(there.socket !== null && asked.some(({ url }) => url.includes('hasJoined')))
    client.end('seen')
    await once(client, 'end')
  }
  // At the second login the token is in the folder.
  assert.deepEqual(lines, ['log in as sally: open https://example.org/link and enter the code ABCD-EFGH'])
  assert.ok(fs.readdirSync(folder).length > 0)
})

test('an account of another name is refused', async () => {
  answers['minecraft/profile'] = profile('steve')
  const client = joining([])
  const [error] = await once(client, 'error')
  assert.match(error.message, /logged in for sally is called steve in the game/)
  assert.equal(client.socket ?? null, null)
})

test('what may be a token is in no message', () => {
  assert.equal(withoutSecrets(`it failed with ${TOKEN}: try again`), 'it failed with ...: try again')
  assert.equal(withoutSecrets('the account sally owns no game'), 'the account sally owns no game')
})
