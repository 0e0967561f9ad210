'use strict'
/**
 * Preparation of a program's text: its form, the insertions that record executed lines, and the mapping from the
 * executed text back to the program's own.
 */

const acorn = require('acorn')
const { Insertions, Lines } = require('./places')
const { cut } = require('./text')

// The parsing time of acorn grows with the square of some constructs: about a second at worst for this length.
const MAX_LENGTH = 40_000
const MAX_LINES = 2000
const MAX_NAME = 80
const MAX_MESSAGE = 1000
const NAME = '__ran'
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
 * Read a program and prepare it for execution.
 * @param {string} source body of an async function. If it consists only of function declarations, the last async function (or
 *   the only function) is called with `bot`
 * @param {string[]} parameters names in scope, `bot` among them
 * @returns {{text: string, marks: number, locate: function(number, number): ?{line: number, column: number}, callee:
 *   function(number, number): ?string, statement: function(number): ?{line: number, column: number}, linesOf:
 *   function(Iterable<number>): number[]}} `text` is an expression of a function of (marks, ...parameters); `marks` is
 *   the length of the array that receives the numbers of executed statements; `locate` maps a position in `text` to
 *   the program, `callee` to the text of the called expression there
 * @throws {ProgramSyntaxError}
 */
function prepareProgram (source, parameters) {
  if (typeof source !== 'string') throw new ProgramSyntaxError(`a program is a text, not ${typeof source}`, null, null)
  const code = source.toWellFormed()
  if (code.length > MAX_LENGTH) throw tooLarge(code.length, 'characters', MAX_LENGTH)
  const lines = new Lines(code)
  if (lines.count > MAX_LINES) throw tooLarge(lines.count, 'lines', MAX_LINES)
  const tree = parse(code)
  const marker = freeName(code)
  const { edits, statements, places, callees } = survey(tree, code, marker, lines)
  const prefix = `(function (${[marker, ...parameters].join(', ')}) { return (async function () {`
  const edited = new Insertions(code, edits)
  const text = `${prefix}${edited.text}\n${entryCall(tree)}})() })`
  let executed = null
  const position = (offset) => lines.place(offset)
  // Map a position in the executed text; only errors need this.
  const original = (line, column) => {
    executed ??= new Lines(text, /\n/g)
    return edited.original(executed.offset(line, column) - prefix.length)
  }
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

function tooLarge (count, what, limit) {
  return new ProgramSyntaxError(`the program has ${count} ${what}, the limit is ${limit}`, null, null)
}

function parse (code) {
  try {
    return acorn.parse(code, {
      ecmaVersion: 'latest', sourceType: 'script', allowReturnOutsideFunction: true, allowAwaitOutsideFunction: true
    })
  } catch (error) {
    if (error instanceof SyntaxError) {
      const message = error.message.replace(/ \(\d+:\d+\)$/, '')
      throw new ProgramSyntaxError(`SyntaxError: ${cut(message, MAX_MESSAGE)}`, error.loc.line, error.loc.column + 1)
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
  const used = code.match(/__ran_*/g)
  return used === null ? NAME : NAME.padEnd(Math.max(...used.map(({ length }) => length)) + 1, '_')
}

function survey (tree, code, marker, lines) {
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
    if (node.type === 'ImportExpression') refuseImport(node, lines)
    const list = STATEMENT_LISTS[node.type]
    if (list) node[list].forEach(mark)
    notePlace(node, code, places, callees)
    stack.push(...childrenOf(node))
  }
  edits.sort((a, b) => a.at - b.at)
  return { edits, statements, places, callees }
}

function refuseImport (node, lines) {
  const { line, column } = lines.place(node.start)
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

// The interpreter reports a call at its parenthesis and a member at its dot; map both to the name, where a reader
// looks.
function notePlace (node, code, places, callees) {
  if (node.type === 'MemberExpression') places.set(code.indexOf(node.computed ? '[' : '.', node.object.end), node.property.start)
  if (node.type !== 'NewExpression' && node.type !== 'CallExpression') return
  const { callee } = node
  // `new Name` may have no parenthesis.
  if (callee.end === node.end) return
  const parenthesis = code.indexOf('(', callee.end)
  const named = callee.type === 'MemberExpression' ? callee.property.start : callee.start
  places.set(parenthesis, node.type === 'NewExpression' ? node.start : named)
  callees.set(parenthesis, cut(code.slice(callee.start, callee.end), MAX_NAME))
}

module.exports = { prepareProgram, ProgramSyntaxError }
