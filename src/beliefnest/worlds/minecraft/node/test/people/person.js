'use strict'
/**
 * Person with a Minecraft client, as a process of its own: `node person.js PORT NAME [VERSION]`. It reads programs on
 * its standard input, one a line as JSON, and plays them one after the other. It prints one JSON object a line:
 * `{"here": true}`, `{"done": N}`, `{"failed": why}`, `{"left": why}`. It leaves at the end of its input.
 */
require('../../src/prepare').prepare()
const readline = require('node:readline')
const minecraft = require('minecraft-protocol')
const { rememberBlocks } = require('../../src/blocks')
const { REAL_TIME, startBot } = require('../../src/bots/bot')
const { scopeOf } = require('../../src/scope')
const versions = require('../../src/versions')

const AsyncFunction = (async () => {}).constructor

const tell = message => process.stdout.write(`${JSON.stringify(message)}\n`)

function textOf (reason) {
  const text = typeof reason === 'string' ? reason : reason?.value?.text?.value ?? JSON.stringify(reason)
  return text
}

function main (port, username, version = versions.minecraft) {
  const registry = require('prismarine-registry')(version)
  rememberBlocks(registry)
  const client = minecraft.createClient({ host: '127.0.0.1', port, username, version, auth: 'offline', hideErrors: true })
  const bot = startBot(client, REAL_TIME)
  let why = 'the connection ended'
  client.on('kick_disconnect', ({ reason }) => { why = textOf(reason) })
  client.on('end', () => { tell({ left: why }) })
  bot.on('error', () => {})
  bot.on('message', message => tell({ read: message.toString() }))
  bot.once('spawn', () => {
    tell({ here: true })
    listen(bot)
  })
}

function listen (bot) {
  // The skills' reports are dropped: only agents that BeliefNest plays have them.
  const scope = scopeOf(bot, () => {}, new AbortController().signal)
  const input = readline.createInterface({ input: process.stdin })
  let turn = Promise.resolve()
  let done = 0
  input.on('line', line => {
    turn = turn.then(async () => {
      await new AsyncFunction('bot', ...Object.keys(scope), JSON.parse(line))(bot, ...Object.values(scope))
      tell({ done: ++done })
    }).catch(error => tell({ failed: error.message }))
  })
  input.on('close', () => turn.then(() => bot.quit()))
}

main(Number(process.argv[2]), ...process.argv.slice(3))
