'use strict'
/** The embedded server: flying-squid's plugins on a server object that opens no port. */
const { EventEmitter } = require('node:events')
const Command = require('flying-squid/src/lib/command')
const squidPlugins = require('flying-squid/src/lib/plugins')
const base = require('./base')
const { PLUGINS } = require('./plugins')
const poses = require('./plugins/poses')
const { makeRegional } = require('./regional')

// movement.js keeps poses for players of an embedded server.
const REPLACED = [poses]
const OPTIONS = { 'max-entities': 10000, 'everybody-op': false, gameMode: 0, difficulty: 0 }

/**
 * @param {import('prismarine-registry').Registry} registry of the Minecraft version
 * @returns {EventEmitter} the server; `serv.region` is set to whichever region runs
 */
function createServer (registry) {
  const serv = new EventEmitter()
  serv.setMaxListeners(0)
  Object.assign(serv, {
    registry,
    supportFeature: registry.supportFeature,
    options: { ...OPTIONS, version: registry.version.minecraftVersion },
    commands: new Command({}),
    pluginList: [...base, ...PLUGINS.filter(plugin => !REPLACED.includes(plugin))],
    gameMode: OPTIONS.gameMode,
    difficulty: OPTIONS.difficulty,
    tickCount: 0
  })
  const { minY, height } = registry.dimensionsByName.overworld
  Object.assign(serv, { minY, worldHeight: height })
  addLog(serv)
  makeRegional(serv)
  squidPlugins.builtinPlugins = serv.pluginList
  for (const plugin of serv.pluginList) plugin.server?.(serv, serv.options)
  serv.emit('asap')
  return serv
}

// Descriptors 1 and 2 carry no protocol, but only what is wrong is worth a line.
function addLog (serv) {
  const toStderr = message => process.stderr.write(`server: ${message}\n`)
  const quiet = () => {}
  Object.assign(serv, { info: quiet, log: quiet, debug: undefined, warn: toStderr, err: toStderr })
}

module.exports = { createServer }
