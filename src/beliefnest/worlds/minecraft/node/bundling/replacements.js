'use strict'
/**
 * Modules that the bundle replaces. The replacements contain only the Minecraft version we serve and one registry per
 * version. They leave out code that opens sockets, logs in with an account or searches for files at run time.
 */
const fs = require('node:fs')
const path = require('node:path')
const { MEMOISED } = require('../src/memoise')
const { vec3Text } = require('../src/sandbox/guest/vec3-text')
const { interpreterBytes: _, ...interpreterLimits } = require('../src/sandbox/interpreter')

const ROOT = path.join(__dirname, '..')
const DATA = path.join(ROOT, 'node_modules', 'minecraft-data', 'minecraft-data', 'data')
// Larger files are not inlined; the program reads them on first use.
const INLINE_BYTES = 20000

// File names under which build.js writes the interpreter of agent programs, and the states in which they begin.
const INTERPRETER = 'quickjs.wasm'
const STATES = 'sandbox.msgpack.gz'

// Data of connections and commands. Bots that join in memory do not even need a protocol.
const UNUSED = ['commands']
const UNUSED_IN_MEMORY = [...UNUSED, 'protocol']

const empty = 'module.exports = {}'

/** Replacements of whole modules, by the end of their path, for a program that joins bots in memory. */
const IN_MEMORY = [
  [/minecraft-protocol\/src\/index\.js$/, `module.exports = {
    createClient () { throw new Error('this build joins bots in memory only') }
  }`]
]

/**
 * Replacements for Mineflayer's login with accounts: only device codes, which the user enters on a web page; no
 * passwords, no realms.
 */
const WITH_ACCOUNTS = [
  [/minecraft-protocol\/src\/client\/mojangAuth\.js$/, empty],
  [/(@azure\/msal-node|@xboxreplay\/xboxlive-auth|prismarine-realms)\/.*\.c?js$/, empty]
]

/** Replacements for programs in which nobody logs in with an account. */
const WITHOUT_ACCOUNTS = [
  [/minecraft-protocol\/src\/client\/(mojangAuth|microsoftAuth)\.js$/, `module.exports = () => {
    throw new Error('this build has no accounts')
  }`],
  [/yggdrasil\/src\/index\.js$/, 'module.exports = { server: () => ({}) }']
]

/** Replacements by kind of connection: none ("memory"), outgoing ("client") or incoming ("server"). */
const CONNECTIONS = {
  memory: IN_MEMORY,
  client: [...WITH_ACCOUNTS, [/minecraft-protocol\/src\/index\.js$/, `module.exports = {
    createClient: require('./createClient'), ping: require('./ping')
  }`]],
  host: [...WITHOUT_ACCOUNTS, [/minecraft-protocol\/src\/index\.js$/, `module.exports = {
    createClient () { throw new Error('this build opens no connections') }, createServer: require('./createServer')
  }`]]
}

const STAND_INS = [
  [/flying-squid\/index\.js$/, `module.exports = {
    UserError: require('./src/lib/user_error'), experience: require('./src/lib/experience')
  }`],
  [/flying-squid\/src\/lib\/plugins\/index\.js$/, 'module.exports = { builtinPlugins: null }'],
  [/node\/src\/prepare\.js$/, 'module.exports = { prepare () {} }'],
  [/sandbox\/interpreter\.js$/, `module.exports = {
    ...${JSON.stringify(interpreterLimits)},
    interpreterBytes: () => require('node:fs').readFileSync(require('node:path').join(__dirname, '${INTERPRETER}'))
  }`],
  [/sandbox\/guest\/vec3-text\.js$/, `module.exports = ${JSON.stringify({ vec3Text })}`],
  [/sandbox\/beginning\.js$/, `module.exports = {
    readyMade () {
      const packed = require('node:fs').readFileSync(require('node:path').join(__dirname, '${STATES}'))
      const { pieces, runtime, context, functions, scope } = require('@msgpack/msgpack').decode(require('node:zlib').gunzipSync(packed)).guest
      return { scope, functions, state: { pages: pieces.map(([place, bytes]) => ({ place, bytes })), runtime, context } }
    }
  }`],
  // The protocol definitions come from packages and are correct; validating them costs a tenth of the start.
  [/protodef-validator\/index\.js$/, `module.exports = class {
    addType () {}
    addTypes () {}
    validateType () {}
    validateTypeGoingInside () {}
    validateProtocol () {}
  }`],
  [/minecraft-data\/minecraft-data\/schemas\/.*\.json$/, empty],
  [/minecraft-data\/minecraft-data\/data\/bedrock\/common\/(legacy|features)\.json$/, empty],
  [/prismarine-registry\/lib\/bedrock\/index\.js$/, empty],
  [/prismarine-chunk\/src\/bedrock\/.*\.js$/, empty]
]

/** Return minecraft-data's index of versions, reduced to `version` and without unused parts. @returns {string} */
function versionIndex (version, unused, further = '') {
  const paths = JSON.parse(fs.readFileSync(path.join(DATA, 'dataPaths.json'))).pc[version]
  const getters = Object.entries(paths).filter(([name]) => !unused.includes(name))
    .filter(([name, folder]) => fs.existsSync(path.join(DATA, folder, `${name}.json`)))
    .map(([name, folder]) => {
      const file = JSON.stringify(`./minecraft-data/data/${folder}/${name}.json`)
      return `get ${name} () { return require(${file}) }`
    })
  return `const pc = { ${JSON.stringify(version)}: {\n${getters.join(',\n')}\n} }\n${further}\nmodule.exports = { pc, bedrock: {} }`
}

/**
 * Return code that adds further versions, one file each: files beside the program, and files in the folders named by
 * its arguments (versions.js writes them).
 */
function furtherVersions (version) {
  return `require(${JSON.stringify(path.join(ROOT, 'bundling', 'further'))}).add(pc, pc[${JSON.stringify(version)}], [__dirname, ...process.argv.slice(2, -2)])`
}

/**
 * Return an esbuild plugin. `version` is Minecraft's, `outdir` the folder for data files, `connections` a key of
 * CONNECTIONS.
 */
function replacements (version, outdir, connections) {
  const standIns = [...STAND_INS, ...CONNECTIONS[connections]]
  return {
    name: 'replacements',
    setup (build) {
      for (const [filter, contents] of standIns) {
        build.onLoad({ filter }, ({ path: file }) => ({ contents, loader: 'js', resolveDir: path.dirname(file) }))
      }
      build.onLoad({ filter: /minecraft-data\/data\.js$/ }, ({ path: file }) => ({
        contents: versionIndex(version, connections === 'memory' ? UNUSED_IN_MEMORY : UNUSED, connections === 'client' ? furtherVersions(version) : ''), loader: 'js', resolveDir: path.dirname(file)
      }))
      build.onLoad({ filter: /minecraft-data\/minecraft-data\/data\/pc\/.*\.json$/ }, ({ path: file }) => ({
        contents: dataModule(file, outdir), loader: 'js'
      }))
      build.onLoad({ filter: /prismarine-physics\/lib\/features\.json$/ }, ({ path: file }) => ({
        contents: connections === 'client' ? fs.readFileSync(file) : JSON.stringify(physicsFeatures(file, version)), loader: 'json'
      }))
      memoise(build)
    }
  }
}

// Physics asks for features many times a tick and searches all features and versions each time; look them up now.
function physicsFeatures (file, version) {
  const major = version.split('.').slice(0, 2).join('.')
  return JSON.parse(fs.readFileSync(file)).filter(({ versions }) => versions.includes(major))
    .map(({ name }) => ({ name, versions: [major] }))
}

// Parsing a JSON text on first use is faster than loading the same data as program text.
function dataModule (file, outdir) {
  const text = JSON.stringify(JSON.parse(fs.readFileSync(file)))
  if (text.length <= INLINE_BYTES) return `module.exports = ${text}`
  const name = `data-${path.basename(path.dirname(file))}-${path.basename(file)}`
  fs.writeFileSync(path.join(outdir, name), text)
  return `module.exports = JSON.parse(require('node:fs').readFileSync(require('node:path').join(__dirname, ${JSON.stringify(name)}), 'utf8'))`
}

// The main module of each package creates an object per version; the bundle creates it only once.
function memoise (build) {
  const memoiser = JSON.stringify(path.join(ROOT, 'src', 'memoise.js'))
  const missing = new Set(MEMOISED)
  for (const name of MEMOISED) {
    const { main = 'index.js' } = require(`${name}/package.json`)
    const file = path.posix.join(name, main).replaceAll('.', '\\.')
    build.onLoad({ filter: new RegExp(`node_modules/${file}$`) }, ({ path: original }) => {
      missing.delete(name)
      return {
        contents: `${fs.readFileSync(original, 'utf8')}\nmodule.exports = require(${memoiser}).memoised(module.exports)`,
        loader: 'js',
        resolveDir: path.dirname(original)
      }
    })
  }
  build.onEnd(() => missing.size === 0
    ? undefined
    : { errors: [{ text: `not in the bundle, or not where expected: ${[...missing].join(', ')}` }] })
}

module.exports = { INTERPRETER, STATES, replacements }
