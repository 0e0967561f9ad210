'use strict'
/** Programs that replace built-ins of the language. Their messages must be like those of any other program. */
const assert = require('node:assert/strict')
const { before, describe, it } = require('node:test')
const { createSandbox } = require('../../src/sandbox')
const { messagesOf, PATCHES, USES } = require('./patches')

describe('built-ins that a program has replaced', () => {
  let sandbox
  let honest
  before(async () => {
    sandbox = createSandbox({ fuel: 15_000_000 })
    honest = await messagesOf(sandbox, USES)
    assert.ok(honest.length > 20)
  })

  for (const [what, patch] of Object.entries(PATCHES)) {
    it(`have no part in what leaves it: ${what}`, async () => {
      const messages = await messagesOf(sandbox, `${patch}\n${USES}`)
      // Values that it gets may be broken by its own replacements, so that it ends early.
      assert.ok(messages.length > 0)
      assert.deepEqual(messages, honest.slice(0, messages.length))
    })
  }
})
