'use strict'
/** Embedded server: flying-squid's plugins on a server object that opens no port. */
const { EventEmitter } = require('node:events')
const Command = require('flying-squid/src/lib/command')
const squidPlugins = require('flying-squid/src/lib/plugins')
const base = require('./base')
const additional = require('./plugins')
const { makeRegional } = require('./regional')

const OPTIONS = { 'max-entities': 10000, 'everybody-op': false, gameMode: 0, difficulty: 0 }

/**
 * Create the server.
 * @param {import('prismarine-registry').Registry} registry registry of the Minecraft version
 * @returns {EventEmitter} the server; `serv.region` is the running region
 */
function createServer (registry) {
  const serv = new EventEmitter()
  serv.setMaxListeners(0)
  Object.assign(serv, {
    registry,
    supportFeature: registry.supportFeature,
    options: { ...OPTIONS, version: registry.version.minecraftVersion },
    commands: new Command({}),
    pluginList: replaceByName(base, additional),
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

/** Return `first` without the plugins whose names occur in `later`, followed by all of `later` in order. */
function replaceByName (first, later) {
  const replaced = new Set(later.map(plugin => plugin.name))
  return [...first.filter(plugin => !replaced.has(plugin.name)), ...later]
}

// Write only warnings and errors. Descriptors 1 and 2 do not carry the channel, but other lines are not worth reading.
function addLog (serv) {
  const toStderr = message => process.stderr.write(`server: ${message}\n`)
  const quiet = () => {}
  Object.assign(serv, { info: quiet, log: quiet, debug: undefined, warn: toStderr, err: toStderr })
}

module.exports = { createServer }
