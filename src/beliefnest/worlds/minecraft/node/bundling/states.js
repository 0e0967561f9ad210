'use strict'
/**
 * States of interpreters in which agent programs begin, made once here: that of a program with nothing but its scope,
 * for both worlds, and that of the desk of the scripted world (src/sandbox/desk.js).
 */
const { Engine, METER } = require('../src/sandbox/engine')
const { Memories } = require('../src/sandbox/memories')
const { QuickJS } = require('../src/sandbox/quickjs')
const { interpreterBytes } = require('../src/sandbox/interpreter')

const DESK_BYTES = 32 * 2 ** 20

/**
 * Return the state in which every program of a scope begins.
 * @param {import('../src/sandbox/engine').Scope} scope
 */
async function guestState (scope) {
  const { state, functions } = await new Engine().templateOf(scope)
  return packed(state, functions)
}

/**
 * Return the state of a desk that knows a registry.
 * @param {string} code text of the desk
 * @param {object} registry as for `know`
 */
async function deskState (code, registry) {
  const host = { call: () => 0, interrupt: () => false, rejected: () => {} }
  const interpreter = await QuickJS.open(new WebAssembly.Module(interpreterBytes()), new Memories().take(DESK_BYTES), host)
  interpreter.create(METER.shadowStackBytes)
  const dispatch = interpreter.evaluate(`${code}\ndesk.dispatch`, 'desk.js')
  const message = interpreter.string(JSON.stringify(['know', registry]))
  interpreter.free(interpreter.call(dispatch, [message]))
  interpreter.free(message)
  return packed(interpreter.save(), { dispatch })
}

/** Join neighbouring pages. */
function packed ({ pages, runtime, context }, functions) {
  const pieces = []
  for (const { place, bytes } of pages) {
    const last = pieces.at(-1)
    if (last !== undefined && last.end === place) {
      last.parts.push(bytes)
      last.end += bytes.length
    } else {
      pieces.push({ place, end: place + bytes.length, parts: [bytes] })
    }
  }
  return { pieces: pieces.map(({ place, parts }) => [place, Buffer.concat(parts)]), runtime, context, functions }
}

module.exports = { deskState, guestState }
