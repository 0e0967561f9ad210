'use strict'
const assert = require('node:assert/strict')
const { describe, it } = require('node:test')
const { prepareProgram, ProgramSyntaxError } = require('../../src/sandbox/program')

const prepare = code => prepareProgram(code, ['bot'])

describe('the text of a program', () => {
  it('maps every character of the executed text back', () => {
    const code = 'let a = 1\r\nif (a) {\n  a = 2; a++\n}\nfor (const b of [1]) { a += b }\n// end'
    const { text, locate } = prepare(code)
    const lines = text.split('\n')
    for (const [needle, line, column] of [['let a', 1, 1], ['a++', 3, 10], ['a += b', 5, 24], ['if (a)', 2, 1]]) {
      const row = lines.findIndex(content => content.includes(needle))
      assert.deepEqual(locate(row + 1, lines[row].indexOf(needle) + 1), { line, column }, needle)
    }
  })

  it('puts the place of a call on the name that is called', () => {
    const code = 'bot.pathfinder.goto(1); new Foo(); bar  (2)'
    const { text, locate, callee } = prepare(code)
    const at = needle => [1, text.indexOf(needle) + 1]
    assert.deepEqual(locate(...at('(1)')), { line: 1, column: 16 })
    assert.equal(callee(...at('(1)')), 'bot.pathfinder.goto')
    assert.deepEqual(locate(...at('(); ')), { line: 1, column: 25 })
    assert.deepEqual(locate(...at('(2)')), { line: 1, column: 36 })
  })

  it('knows no place outside the program', () => {
    const { locate } = prepare('a()')
    assert.equal(locate(1, 1), null)
    assert.equal(locate(1, 10000), null)
    assert.equal(locate(99, 1), null)
  })

  it('keeps directives first', () => {
    assert.match(prepare('"use strict"; x = 1').text, /\{"use strict";/)
  })

  it('chooses a name for its marks that the program does not use', () => {
    assert.match(prepare('__ran; x').text, /^\(function \(__ran_, bot\)/)
  })

  it('calls the last async function, if there are only functions', () => {
    assert.match(prepare('async function a(bot) {}\nfunction b() {}').text, /\nreturn a\(bot\)\n/)
    assert.match(prepare('function b() {}').text, /\nreturn b\(bot\)\n/)
    assert.doesNotMatch(prepare('async function a(bot) {}\na(bot)').text, /return a/)
  })

  for (const [what, code, message, line, column] of [
    ['an unexpected token', 'let a = 1\nlet b = ;', /^SyntaxError: Unexpected token$/, 2, 9],
    ['an open brace', 'if (1) {\n', /Unexpected token/, 2, 1],
    ['a brace too many', 'a()\n}', /Unexpected token/, 2, 1],
    ['an import', '\n  await import("fs")', /import is not available/, 2, 9],
    ['a declaration twice', 'let a; let a', /already been declared/, 1, 12],
    ['a bare function', 'async (bot) => {}', /without a name/, 1, 1],
    ['no text', 7, /a program is a text, not number/, null, null],
    ['too much text', ' '.repeat(40001), /40001 characters, the limit is 40000/, null, null],
    ['too many lines', '0\n'.repeat(20000), /20001 lines, the limit is 2000/, null, null],
    ['deep nesting', '['.repeat(40000), /nested too deeply/, null, null]
  ]) {
    it(`refuses ${what}`, () => {
      assert.throws(() => prepare(code), error => {
        assert.ok(error instanceof ProgramSyntaxError)
        assert.match(error.message, message)
        assert.deepEqual([error.line, error.column], [line, column])
        return true
      })
    })
  }
})
