'use strict'
/** Bundling of the host's side of the sandbox into one text that an interpreter can read (src/sandbox/desk.js). */
const esbuild = require('esbuild')

// Goals never reach a skill, and this side has no pathfinder; it only has to know a goal when it sees one.
const NO_GOALS = `
  class Goal {}
  module.exports = { buildGoal: () => new Goal(), buildMovements: () => new Goal() }
`

const withoutGoals = {
  name: 'without-goals',
  setup (build) {
    build.onLoad({ filter: /sandbox[\\/]constructions\.js$/ }, () => ({ contents: NO_GOALS, loader: 'js' }))
  }
}

/** Return the text of the desk, and the files that it is made of. @returns {Promise<{code: string, inputs: object}>} */
async function bundledDesk (file) {
  const { metafile, outputFiles: [{ text }] } = await esbuild.build({
    entryPoints: [file],
    write: false,
    bundle: true,
    platform: 'neutral',
    mainFields: ['main'],
    format: 'iife',
    globalName: 'desk',
    target: 'es2022',
    external: ['prismarine-chat'],
    minifySyntax: true,
    minifyWhitespace: true,
    legalComments: 'none',
    metafile: true,
    logLevel: 'warning',
    plugins: [withoutGoals]
  })
  return { code: text, inputs: metafile.inputs }
}

module.exports = { bundledDesk }
