/** Build of the page's program and style sheet: `node build.js [OUTDIR]`. Python inserts both into the page. */

import fs from 'node:fs'
import path from 'node:path'
import esbuild from 'esbuild'

const HERE = import.meta.dirname
const DEFAULT_OUTDIR = path.join(HERE, '..', '..', '..', '_page')

async function build (outdir) {
  fs.rmSync(outdir, { recursive: true, force: true })
  const result = await esbuild.build({
    entryPoints: { page: path.join(HERE, 'src', 'main.js'), editor: path.join(HERE, 'src', 'editor.js') },
    outdir,
    bundle: true,
    format: 'iife',
    platform: 'browser',
    target: ['chrome110', 'firefox115', 'safari16.4'],
    minify: true,
    legalComments: 'none',
    metafile: true,
    logLevel: 'warning'
  })
  const style = await esbuild.transform(fs.readFileSync(path.join(HERE, 'style.css'), 'utf8'), { loader: 'css', minify: true })
  fs.writeFileSync(path.join(outdir, 'page.css'), style.code)
  const packages = packagesOf(result.metafile)
  fs.writeFileSync(path.join(outdir, 'packages.json'), `${JSON.stringify(packages, null, 1)}\n`)
}

/** Return version and licence, by name, of the packages whose code is in the program. @returns {object} */
function packagesOf (metafile) {
  const packages = {}
  for (const input of Object.keys(metafile.inputs)) {
    const [, name] = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input) ?? []
    if (name === undefined) continue
    const manifest = JSON.parse(fs.readFileSync(path.join(HERE, 'node_modules', name, 'package.json')))
    packages[name] = { version: manifest.version, license: manifest.license }
  }
  return packages
}

build(path.resolve(process.argv[2] ?? DEFAULT_OUTDIR)).catch(error => {
  process.stderr.write(`${error.message}\n`)
  process.exit(1)
})
