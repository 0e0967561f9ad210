'use strict'
/** Runs a program's text in this very process: for programs of one's own only. */
const vm = require('node:vm')

const FILE = 'program.js'

/**
 * @param {object} request
 * @param {string} request.code the body of an async function, or one whole function of `bot`
 * @param {object} request.bot
 * @param {object} request.scope what else the program finds in scope, by name
 * @returns {Promise<{ok: boolean, error: object | null}>} see RESULT in design/channel.md
 */
async function evaluate ({ code, bot, scope }) {
  try {
    const names = ['bot', ...Object.keys(scope)]
    const outcome = await compile(code, names)(bot, ...Object.values(scope))
    if (typeof outcome === 'function') await outcome(bot)
    return { ok: true, error: null }
  } catch (error) {
    return { ok: false, error: describe(error) }
  }
}

// One whole function is an expression; a body seldom is, and is run as such then.
function compile (code, names) {
  const head = `(async (${names.join(', ')}) => {`
  const asExpression = `${head}return (\n${code}\n)})`
  const asBody = `${head}\n${code}\n})`
  for (const text of [asExpression, asBody]) {
    try {
      return new vm.Script(text, { filename: FILE, lineOffset: -1 }).runInThisContext()
    } catch (error) {
      if (text === asBody || !(error instanceof SyntaxError)) throw error
    }
  }
  return undefined
}

function describe (error) {
  const place = placeOf(error)
  return {
    kind: error instanceof SyntaxError ? 'syntax' : 'error',
    message: error instanceof Error ? error.message : String(error),
    line: place?.line ?? null,
    column: place?.column ?? null,
    skill: error?.skill ?? null
  }
}

function placeOf (error) {
  const match = /program\.js:(\d+)(?::(\d+))?/.exec(String(error?.stack))
  if (match === null) return null
  return { line: Number(match[1]), column: match[2] === undefined ? null : Number(match[2]) }
}

module.exports = { evaluate }
