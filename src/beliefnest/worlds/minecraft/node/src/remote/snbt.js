'use strict'
/**
 * Parser of SNBT, the game's text notation of data, in which the server answers `/data get`:
 * `[{Slot: 0b, id: "minecraft:bread", Count: 2b}]`. Numbers lose their type; typed arrays become lists.
 */

const TOKEN = /\s*(?:([{}[\],:;])|"((?:[^"\\]|\\.)*)"|'((?:[^'\\]|\\.)*)'|([^\s{}[\],:;"']+))/sy
const NUMBER = /^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[bslfdBSLFD]?$/
const ARRAYS = ['B', 'I', 'L']

/** Parse a text. @throws {SyntaxError} if the text is not SNBT */
function parseSnbt (text) {
  const tokens = tokensOf(text)
  const value = valueAt(tokens)
  if (tokens.length > 0) throw new SyntaxError('there is text after the end of the data')
  return value
}

function tokensOf (text) {
  const tokens = []
  const pattern = new RegExp(TOKEN)
  const end = text.trimEnd().length
  while (pattern.lastIndex < end) {
    const at = pattern.lastIndex
    const match = pattern.exec(text)
    if (match === null) throw new SyntaxError(`data cannot be read from character ${at} on`)
    const [, mark, double, single, word] = match
    const quoted = double ?? single
    tokens.push(quoted === undefined ? { mark, word } : { word: quoted.replace(/\\(.)/gs, '$1'), isText: true })
  }
  return tokens
}

function valueAt (tokens) {
  const token = tokens.shift()
  if (token === undefined) throw new SyntaxError('data ends too early')
  if (token.mark === '{') return compoundAt(tokens)
  if (token.mark === '[') return listAt(tokens)
  if (token.mark !== undefined) throw new SyntaxError(`data has ${token.mark} where a value should be`)
  return token.isText || !NUMBER.test(token.word) ? token.word : Number.parseFloat(token.word)
}

function compoundAt (tokens) {
  const entries = []
  while (tokens[0]?.mark !== '}') {
    const { word } = tokens.shift() ?? {}
    if (word === undefined) throw new SyntaxError('data has no name where one should be')
    expect(tokens, ':')
    entries.push([word, valueAt(tokens)])
    if (tokens[0]?.mark !== '}') expect(tokens, ',')
  }
  tokens.shift()
  return Object.fromEntries(entries)
}

function listAt (tokens) {
  const list = []
  if (ARRAYS.includes(tokens[0]?.word) && tokens[1]?.mark === ';') tokens.splice(0, 2)
  while (tokens[0]?.mark !== ']') {
    list.push(valueAt(tokens))
    if (tokens[0]?.mark !== ']') expect(tokens, ',')
  }
  tokens.shift()
  return list
}

function expect (tokens, mark) {
  const token = tokens.shift()
  if (token?.mark !== mark) throw new SyntaxError(`data has ${token?.mark ?? token?.word ?? 'its end'} where ${mark} should be`)
}

module.exports = { parseSnbt }
