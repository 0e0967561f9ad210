'use strict'
/**
 * The text of a program: what form it has, what is inserted into it so that the lines that ran
 * are known, and which place in the text a place in the executed text stands for.
 */

const acorn = require('acorn')

const MAX_LENGTH = 200_000
const MAX_NAME = 80
const STATEMENT_LISTS = { Program: 'body', BlockStatement: 'body', StaticBlock: 'body', SwitchCase: 'consequent' }
const SKIPPED_KEYS = new Set(['type', 'start', 'end'])

class ProgramSyntaxError extends Error {
  /**
   * @param {string} message
   * @param {number|null} line from 1
   * @param {number|null} column from 1
   */
  constructor (message, line, column) {
    super(message)
    this.name = 'ProgramSyntaxError'
    this.line = line
    this.column = column
  }
}

/**
 * Reads a program and prepares it for execution.
 * @param {string} code the body of an async function, or function declarations only, of which the
 *   last async one (or the only one) is called with `bot`
 * @param {string[]} parameters the names in scope, `bot` among them
 * @returns {{text: string, marks: number, locate: function(number, number): ?{line: number, column: number},
 *   callee: function(number, number): ?string,
 *   statement: function(number): ?{line: number, column: number}, linesOf: function(Iterable<number>): number[]}}
 *   `text` is an expression, a function of (marks, ...parameters); `marks` the length of the array that
 *   takes the numbers of executed statements; `locate` maps a place in `text` to one in
 *   `code`, `callee` to the text of what is called there
 * @throws {ProgramSyntaxError}
 */
function prepareProgram (code, parameters) {
  if (typeof code !== 'string') throw new ProgramSyntaxError(`a program is a text, not ${typeof code}`, null, null)
  if (code.length > MAX_LENGTH) {
    throw new ProgramSyntaxError(`the program has ${code.length} characters, the limit is ${MAX_LENGTH}`, null, null)
  }
  const tree = parse(code)
  const marker = freeName(code)
  const { edits, statements, places, callees } = survey(tree, code, marker)
  const prefix = `(function (${[marker, ...parameters].join(', ')}) { return (async function () {`
  const text = `${prefix}${applyEdits(code, edits)}\n${entryCall(tree)}})() })`
  const position = (offset) => offsetToPlace(code, offset)
  const original = (line, column) => originalOffset(placeToOffset(text, line, column) - prefix.length, edits)
  return {
    text,
    marks: statements.length + 1,
    locate: (line, column) => {
      const offset = original(line, column)
      return offset < 0 || offset > code.length ? null : position(places.get(offset) ?? offset)
    },
    callee: (line, column) => callees.get(original(line, column)) ?? null,
    statement: (number) => number >= 1 && number <= statements.length ? position(statements[number - 1]) : null,
    linesOf: (numbers) => [...new Set(Array.from(numbers, (n) => position(statements[n - 1]).line))].sort((a, b) => a - b)
  }
}

function parse (code) {
  try {
    return acorn.parse(code, {
      ecmaVersion: 'latest', sourceType: 'script', allowReturnOutsideFunction: true, allowAwaitOutsideFunction: true
    })
  } catch (error) {
    if (error instanceof SyntaxError) {
      const message = error.message.replace(/ \(\d+:\d+\)$/, '')
      throw new ProgramSyntaxError(`SyntaxError: ${message}`, error.loc.line, error.loc.column + 1)
    }
    if (error instanceof RangeError) throw new ProgramSyntaxError('SyntaxError: the program is nested too deeply', null, null)
    throw error
  }
}

function entryCall (tree) {
  const [first] = tree.body
  if (tree.body.length === 1 && first.type === 'ExpressionStatement' && /Function/.test(first.expression.type)) {
    throw new ProgramSyntaxError('SyntaxError: the program is a function without a name; write "async function name(bot) {...}"', 1, 1)
  }
  if (tree.body.length === 0 || !tree.body.every((node) => node.type === 'FunctionDeclaration')) return ''
  const entry = tree.body.findLast((node) => node.async) ?? tree.body.at(-1)
  return `return ${entry.id.name}(bot)\n`
}

function freeName (code) {
  let name = '__ran'
  while (code.includes(name)) name += '_'
  return name
}

function survey (tree, code, marker) {
  const edits = []
  const statements = []
  const places = new Map()
  const callees = new Map()
  const mark = (node) => {
    if (node.type === 'FunctionDeclaration' || node.directive !== undefined) return
    statements.push(node.start)
    edits.push({ at: node.start, text: `${marker}[0]=${marker}[${statements.length}]=${statements.length};` })
  }
  const stack = [tree]
  while (stack.length > 0) {
    const node = stack.pop()
    if (node.type === 'ImportExpression') refuseImport(node, code)
    const list = STATEMENT_LISTS[node.type]
    if (list) node[list].forEach(mark)
    notePlace(node, code, places, callees)
    stack.push(...childrenOf(node))
  }
  edits.sort((a, b) => a.at - b.at)
  return { edits, statements, places, callees }
}

function refuseImport (node, code) {
  const { line, column } = offsetToPlace(code, node.start)
  throw new ProgramSyntaxError('SyntaxError: import is not available to a program', line, column)
}

function childrenOf (node) {
  const children = []
  for (const key of Object.keys(node)) {
    if (SKIPPED_KEYS.has(key)) continue
    const value = node[key]
    for (const child of Array.isArray(value) ? value : [value]) {
      if (child !== null && typeof child === 'object' && typeof child.type === 'string') children.push(child)
    }
  }
  return children
}

// The interpreter names the parenthesis of a call and the dot of a member; a reader looks for the name.
function notePlace (node, code, places, callees) {
  if (node.type === 'MemberExpression') places.set(code.indexOf(node.computed ? '[' : '.', node.object.end), node.property.start)
  if (node.type !== 'NewExpression' && node.type !== 'CallExpression') return
  const { callee } = node
  const parenthesis = code.indexOf('(', callee.end)
  const named = callee.type === 'MemberExpression' ? callee.property.start : callee.start
  places.set(parenthesis, node.type === 'NewExpression' ? node.start : named)
  callees.set(parenthesis, code.slice(callee.start, callee.end).slice(0, MAX_NAME))
}

function applyEdits (code, edits) {
  const parts = []
  let from = 0
  for (const { at, text } of edits) {
    parts.push(code.slice(from, at), text)
    from = at
  }
  return parts.join('') + code.slice(from)
}

function originalOffset (offset, edits) {
  let inserted = 0
  for (const { at, text } of edits) {
    if (at + inserted >= offset) break
    if (at + inserted + text.length > offset) return at
    inserted += text.length
  }
  return offset - inserted
}

function offsetToPlace (text, offset) {
  const before = text.slice(0, offset).split(/\r\n|[\n\r\u2028\u2029]/)
  return { line: before.length, column: before.at(-1).length + 1 }
}

function placeToOffset (text, line, column) {
  let offset = 0
  for (let n = 1; n < line; n++) {
    const next = text.indexOf('\n', offset)
    if (next < 0) return -1
    offset = next + 1
  }
  return offset + column - 1
}

module.exports = { prepareProgram, ProgramSyntaxError }
