'use strict'
const assert = require('node:assert/strict')
const { execFileSync } = require('node:child_process')
const { it } = require('node:test')
const { MAIN } = require('../harness')

it('a walk is measured with the sandbox and without, and takes as many ticks in both', () => {
  const pairs = JSON.parse(execFileSync(process.execPath, [MAIN, 'containment', '2']))
  assert.equal(pairs.length, 2)
  for (const { contained, direct } of pairs) assert.ok(contained > 0 && direct > 0)
})
