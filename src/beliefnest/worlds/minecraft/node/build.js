'use strict'
/**
 * Build of the bundle that Python starts: `node build.js [OUTDIR]`. The bundle runs without node_modules and contains
 * the data of one Minecraft version.
 */
const fs = require('node:fs')
const path = require('node:path')
const zlib = require('node:zlib')
const esbuild = require('esbuild')
const { encode } = require('@msgpack/msgpack')
const { MINECRAFT_VERSION, buildRegistry } = require('./registry')
const { buildHandling } = require('./handling')
const { buildCircuits } = require('./circuits')
const { INITIAL_PAGES, interpreterBytes } = require('./src/sandbox/interpreter')
const { DEFAULTS, namesOf } = require('./src/sandbox')
const { METER } = require('./src/sandbox/engine')
const { announced, events } = require('./src/sandbox/policy/events')
const { LIMITS, REQUEST_COST } = require('./src/sandbox/session')
const { interpreterNames } = require('./bundling/interpreter')
const { bundledDesk } = require('./bundling/desk')
const { deskState, guestState } = require('./bundling/states')
const { SKILLS } = require('../../../skills/code')
const { INTERPRETER, STATES, replacements } = require('./bundling/replacements')
const { FURTHER, writeVersions } = require('./bundling/versions')

const SOURCE = path.join(__dirname, 'src')
const DEFAULT_OUTDIR = path.join(__dirname, '..', '..', '..', '_bundle')

async function build (outdir) {
  fs.rmSync(outdir, { recursive: true, force: true })
  fs.mkdirSync(outdir, { recursive: true })
  // Build three programs, so that the one that opens no sockets contains no code that could open one.
  const inputs = await bundle(outdir, ['main.js', path.join('channel', 'lifeline.js')], 'memory')
  Object.assign(inputs, await bundle(outdir, ['realtime.js'], 'client'), await bundle(outdir, ['hosting.js'], 'host'))
  fs.writeFileSync(
    path.join(outdir, `registry-${MINECRAFT_VERSION}.msgpack`), encode(buildRegistry(MINECRAFT_VERSION)))
  fs.writeFileSync(
    path.join(outdir, `handling-${MINECRAFT_VERSION}.msgpack`), encode(buildHandling(MINECRAFT_VERSION)))
  fs.writeFileSync(
    path.join(outdir, `circuits-${MINECRAFT_VERSION}.msgpack`), encode(buildCircuits(MINECRAFT_VERSION)))
  writeVersions(outdir, FURTHER)
  fs.writeFileSync(path.join(outdir, INTERPRETER), interpreterBytes())
  const desk = await bundledDesk(path.join(SOURCE, 'sandbox', 'desk.js'))
  Object.assign(inputs, desk.inputs)
  fs.writeFileSync(path.join(outdir, STATES), zlib.gzipSync(encode(await sandbox(desk.code))))
  const folders = packageFolders(inputs)
  fs.writeFileSync(path.join(outdir, 'packages.json'), `${JSON.stringify(packageList(folders), null, 1)}\n`)
  fs.writeFileSync(path.join(outdir, 'licenses.txt'), licenseTexts(folders))
}

/** Return the states in which programs begin, and what else the scripted world needs of the sandbox. @returns {Promise<object>} */
async function sandbox (desk) {
  const { itemsArray, blocksArray } = require('minecraft-data')(MINECRAFT_VERSION)
  const registry = { items: itemsArray.map(({ name }) => name), blocks: Object.fromEntries(blocksArray.map(({ name, states }) => [name, states])) }
  const scope = namesOf({ skills: Object.fromEntries(SKILLS.map(({ name }) => [name, null])), data: {} })
  return {
    ...await interpreterNames(),
    scope: scope.parameters,
    events: Object.keys(events),
    announced: Object.keys(announced),
    limits: { ...DEFAULTS, ...LIMITS },
    meter: { ...METER, initialPages: INITIAL_PAGES },
    cost: REQUEST_COST,
    guest: { ...await guestState(scope), scope: JSON.stringify(scope) },
    desk: await deskState(desk, registry)
  }
}

/** Build programs into one folder. @returns {Promise<object>} inputs of the programs, by file */
async function bundle (outdir, programs, connections) {
  const { metafile } = await esbuild.build({
    entryPoints: programs.map(program => path.join(SOURCE, program)),
    entryNames: '[name]',
    outdir,
    bundle: true,
    platform: 'node',
    target: 'node24',
    minifySyntax: true,
    minifyWhitespace: true,
    legalComments: 'linked',
    metafile: true,
    logLevel: 'warning',
    define: { BUNDLED: 'true' },
    plugins: [replacements(MINECRAFT_VERSION, outdir, connections)]
  })
  return metafile.inputs
}

/** Return the folders of the packages whose code or data the bundle contains, sorted by name. @returns {string[]} */
function packageFolders (inputs) {
  const folders = new Set()
  for (const input of Object.keys(inputs)) {
    const parts = input.split('/')
    const last = parts.lastIndexOf('node_modules')
    if (last === -1) continue
    const names = parts[last + 1].startsWith('@') ? 2 : 1
    folders.add(path.resolve(parts.slice(0, last + 1 + names).join('/')))
  }
  return [...folders].sort()
}

function manifestOf (folder) {
  return JSON.parse(fs.readFileSync(path.join(folder, 'package.json')))
}

/** Return version and licence by package name. @returns {object} */
function packageList (folders) {
  return Object.fromEntries(folders.map(folder => {
    const { name, version, license } = manifestOf(folder)
    return [name, { version, license }]
  }))
}

/** Return the licence texts of the packages, each under the name of its package. @returns {string} */
function licenseTexts (folders) {
  return folders.map(folder => {
    const { name, version, license, author } = manifestOf(folder)
    const file = fs.readdirSync(folder).find(entry => /^(licen[cs]e|copying)/i.test(entry))
    const by = typeof author === 'object' ? author.name : author
    const text = file === undefined
      ? `Licensed under ${license} by ${by ?? 'its authors'}; the package carries no licence text.`
      : fs.readFileSync(path.join(folder, file), 'utf8').trim()
    return `== ${name} ${version} (${license})\n\n${text}\n`
  }).join('\n')
}

build(path.resolve(process.argv[2] ?? DEFAULT_OUTDIR)).catch(error => {
  process.stderr.write(`${error.message}\n`)
  process.exit(1)
})
