'use strict'
/** Index of further Minecraft versions, built when the program starts. The data of a version is read on first use. */
const fs = require('node:fs')
const path = require('node:path')
const zlib = require('node:zlib')

const NAME = /^minecraft-(\d[\d.]*\d)\.json\.gz$/

/**
 * Add the versions whose files lie in `folders` to the index.
 * @param {object} versions minecraft-data's index
 * @param {object} ours version for which the program was built; the others use its texts
 * @param {string[]} folders
 */
function add (versions, ours, folders) {
  for (const folder of folders) {
    for (const file of fs.readdirSync(folder)) {
      const [, version] = NAME.exec(file) ?? []
      if (version === undefined || version in versions) continue
      let data = null
      const get = () => (data ??= { ...JSON.parse(zlib.gunzipSync(fs.readFileSync(path.join(folder, file)))), language: ours.language })
      Object.defineProperty(versions, version, { enumerable: true, get })
    }
  }
}

module.exports = { add }
