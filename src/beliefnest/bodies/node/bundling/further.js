'use strict'
/** Finds data of further Minecraft versions when the program starts; each is read when it is first asked for. */
const fs = require('node:fs')
const path = require('node:path')
const zlib = require('node:zlib')

const NAME = /^minecraft-(\d[\d.]*\d)\.json\.gz$/

/**
 * @param {object} versions minecraft-data's index, to which they are added
 * @param {object} ours the version that the program is made for; others have its texts
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
