'use strict'
/**
 * Names within the interpreter of agent programs, for hosts other than Node. Its exports and imports have one letter each;
 * only the JavaScript that comes with it knows which is which.
 */
const loadGlue = require('@jitl/quickjs-wasmfile-release-sync/emscripten-module')

const PAGES = 256
const YEAR = 70
const YEAR_PLACE = 5

/**
 * Return the names of the interpreter's exports and of the imports that do something.
 * @returns {Promise<{exports: Object<string, string>, imports: Object<string, string>}>} `exports`: the letters by name
 *   of the function; `imports`: those by what they do: `call` a host function, poll for an `interrupt`, `grow` the
 *   memory, tell the local `time`
 */
async function interpreterNames () {
  const memory = new WebAssembly.Memory({ initial: PAGES })
  let importsOfGlue
  const letters = new Map()
  const standIn = new Proxy({}, {
    get (_, letter) {
      // The exports travel through a promise, which must not take them for another one.
      if (letter === 'then') return undefined
      const exported = () => 0
      letters.set(exported, letter)
      return exported
    }
  })
  const glue = await loadGlue({
    wasmMemory: memory,
    print: () => {},
    printErr: () => {},
    instantiateWasm: (imports, done) => {
      [importsOfGlue] = Object.values(imports)
      done({ exports: standIn })
      return standIn
    }
  })
  const named = Object.entries(glue).filter(([name, value]) => name.startsWith('_') && letters.has(value))
  const exports = Object.fromEntries(named.map(([name, value]) => [name.slice(1), letters.get(value)]))
  return { exports, imports: importNames(glue, importsOfGlue, memory) }
}

/** Call each import, and look what it does. */
function importNames (glue, imports, memory) {
  const letters = {}
  let letter
  const note = name => () => {
    letters[name] = letter
    return 0
  }
  glue.callbacks = { callFunction: note('call'), shouldInterrupt: note('interrupt') }
  memory.grow = note('grow')
  const words = new Int32Array(memory.buffer)
  for (const [name, act] of Object.entries(imports)) {
    if (typeof act !== 'function') continue
    letter = name
    words.fill(0)
    try {
      act(0, 0, 0, 0, 0)
    } catch {
      // Those that end the process throw.
    }
    if (words[YEAR_PLACE] === YEAR) letters.time = name
  }
  for (const name of ['call', 'interrupt', 'grow', 'time']) {
    if (letters[name] === undefined) throw new Error(`this build of QuickJS has no import that does what bundling/interpreter.js calls ${name}`)
  }
  return letters
}

module.exports = { interpreterNames }
