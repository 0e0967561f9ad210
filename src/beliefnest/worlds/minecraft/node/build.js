'use strict'
/**
 * Build of the bundle that Python starts: `node build.js [OUTDIR]`. The bundle runs without node_modules and contains
 * the data of one Minecraft version.
 */
const fs = require('node:fs')
const path = require('node:path')
const esbuild = require('esbuild')
const { encode } = require('@msgpack/msgpack')
const { MINECRAFT_VERSION, buildRegistry } = require('./registry')
const { buildHandling } = require('./handling')
const { buildCircuits } = require('./circuits')
const { interpreterBytes } = require('./src/sandbox/interpreter')
const { INTERPRETER, replacements } = require('./bundling/replacements')
const { FURTHER, writeVersions } = require('./bundling/versions')

const SOURCE = path.join(__dirname, 'src')
/**
 * Files that Python reads too. The scripted world gives programs the same Vec3 class, dates and random numbers, and
 * the same hints about unknown names.
 */
const SHARED = ['sandbox/guest/vec3.js', 'sandbox/guest/date.js', 'time/sfc32.js', 'sandbox/hints.js']
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
  for (const file of SHARED) await share(path.join(SOURCE, file), outdir)
  const folders = packageFolders(inputs)
  fs.writeFileSync(path.join(outdir, 'packages.json'), `${JSON.stringify(packageList(folders), null, 1)}\n`)
  fs.writeFileSync(path.join(outdir, 'licenses.txt'), licenseTexts(folders))
}

/**
 * Write a file that imports nothing to the bundle, minified: the engine reads it completely each time it starts a
 * program.
 */
async function share (file, outdir) {
  const { code } = await esbuild.transform(fs.readFileSync(file, 'utf8'), { minifySyntax: true, minifyWhitespace: true, target: 'es2022' })
  fs.writeFileSync(path.join(outdir, path.basename(file)), code)
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
