'use strict'
/**
 * What the bundle has instead of some modules: only the Minecraft version we serve, one
 * registry per version, and none of what would open sockets, log in with an account, or look for
 * files at run time.
 */
const fs = require('node:fs')
const path = require('node:path')
const { MEMOISED } = require('../src/memoise')
const { interpreterBytes: _, ...interpreterLimits } = require('../src/sandbox/interpreter')

const ROOT = path.join(__dirname, '..')
const DATA = path.join(ROOT, 'node_modules', 'minecraft-data', 'minecraft-data', 'data')
// Larger ones are kept as files of their own and read when first needed.
const INLINE_BYTES = 20000

// Where build.js puts the interpreter of agent programs.
const INTERPRETER = 'quickjs.wasm'

// Data of connections and commands; bots that are joined in memory do not even have a protocol.
const UNUSED = ['commands']
const UNUSED_IN_MEMORY = [...UNUSED, 'protocol']

const empty = 'module.exports = {}'

/** Whole modules by the end of their path, with what stands for each. */
const IN_MEMORY = [
  [/minecraft-protocol\/src\/index\.js$/, `module.exports = {
    createClient () { throw new Error('this build joins bots in memory only') }
  }`]
]

/** Of Mineflayer's login with accounts, what is used: codes that the user enters on a page; no passwords, no realms. */
const WITH_ACCOUNTS = [
  [/minecraft-protocol\/src\/client\/mojangAuth\.js$/, empty],
  [/(@azure\/msal-node|@xboxreplay\/xboxlive-auth|prismarine-realms)\/.*\.c?js$/, empty]
]

/** Nobody logs in with an account. */
const WITHOUT_ACCOUNTS = [
  [/minecraft-protocol\/src\/client\/(mojangAuth|microsoftAuth)\.js$/, `module.exports = () => {
    throw new Error('this build has no accounts')
  }`],
  [/yggdrasil\/src\/index\.js$/, 'module.exports = { server: () => ({}) }']
]

/** What a program may do with connections, by the name of its sort: none, open them, take them. */
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
  // Protocol definitions come from packages and are right; checking them costs a tenth of a start.
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

/** @returns {string} minecraft-data's index of versions, with only `version` in it and without what is unused */
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

/** Of further versions, one file each: those beside the program, and in folders that it is told of (versions.js). */
function furtherVersions (version) {
  return `require(${JSON.stringify(path.join(ROOT, 'bundling', 'further'))}).add(pc, pc[${JSON.stringify(version)}], [__dirname, ...process.argv.slice(2, -2)])`
}

/** An esbuild plugin. `version` is Minecraft's, `outdir` where data files go, `connections` a name of CONNECTIONS. */
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

// Asked for many times a tick, by going through all features and all their versions.
function physicsFeatures (file, version) {
  const major = version.split('.').slice(0, 2).join('.')
  return JSON.parse(fs.readFileSync(file)).filter(({ versions }) => versions.includes(major))
    .map(({ name }) => ({ name, versions: [major] }))
}

// A text parsed when needed is faster than the same data as program text.
function dataModule (file, outdir) {
  const text = JSON.stringify(JSON.parse(fs.readFileSync(file)))
  if (text.length <= INLINE_BYTES) return `module.exports = ${text}`
  const name = `data-${path.basename(path.dirname(file))}-${path.basename(file)}`
  fs.writeFileSync(path.join(outdir, name), text)
  return `module.exports = JSON.parse(require('node:fs').readFileSync(require('node:path').join(__dirname, ${JSON.stringify(name)}), 'utf8'))`
}

// Each package's main module makes a thing per version; in the bundle it makes it once.
function memoise (build) {
  const memoiser = JSON.stringify(path.join(ROOT, 'src', 'memoise.js'))
  const missing = new Set(MEMOISED)
  for (const name of MEMOISED) {
    const { main = 'index.js' } = require(`${name}/package.json`)
    const file = path.posix.join(name, main).replaceAll('.', '\\.')
    build.onLoad({ filter: new RegExp(`node_modules/${file}$`) }, ({ path: found }) => {
      missing.delete(name)
      return {
        contents: `${fs.readFileSync(found, 'utf8')}\nmodule.exports = require(${memoiser}).memoised(module.exports)`,
        loader: 'js',
        resolveDir: path.dirname(found)
      }
    })
  }
  build.onEnd(() => missing.size === 0
    ? undefined
    : { errors: [{ text: `not in the bundle, or not where expected: ${[...missing].join(', ')}` }] })
}

module.exports = { INTERPRETER, replacements }
