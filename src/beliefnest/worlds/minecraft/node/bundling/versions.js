'use strict'
/** Writer of data files for further Minecraft versions of remote servers: `node versions.js OUTDIR VERSION...`. */
const fs = require('node:fs')
const path = require('node:path')
const zlib = require('node:zlib')

const DATA = path.join(__dirname, '..', 'node_modules', 'minecraft-data', 'minecraft-data', 'data')
// Most played versions besides ours: the last of each line. Each file takes a sixth of a megabyte.
const FURTHER = ['1.20.1', '1.20.2', '1.20.6', '1.21.1', '1.21.4', '1.21.5', '1.21.8', '1.21.11']
// Bots use none of these parts; texts are those of our own version.
const UNUSED = ['commands', 'language', 'blockLoot', 'entityLoot']

/** Write one data file per version. @throws {Error} if minecraft-data does not have a version */
function writeVersions (outdir, versions) {
  const { pc: paths } = JSON.parse(fs.readFileSync(path.join(DATA, 'dataPaths.json')))
  for (const version of versions) {
    if (paths[version] === undefined) throw new Error(`minecraft-data has no Minecraft ${version}`)
    const parts = Object.entries(paths[version]).filter(([name]) => !UNUSED.includes(name))
      .map(([name, folder]) => [name, path.join(DATA, folder, `${name}.json`)]).filter(([, file]) => fs.existsSync(file))
    const text = JSON.stringify(Object.fromEntries(parts.map(([name, file]) => [name, JSON.parse(fs.readFileSync(file))])))
    fs.writeFileSync(path.join(outdir, `minecraft-${version}.json.gz`), zlib.gzipSync(text, { level: 9 }))
  }
}

if (require.main === module) writeVersions(process.argv[2], process.argv.slice(3))

module.exports = { FURTHER, writeVersions }
