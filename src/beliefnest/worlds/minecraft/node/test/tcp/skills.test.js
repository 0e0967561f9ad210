'use strict'
/** The skills' own tests, repeated on a server in another process, over TCP, in real time. */
process.env.BELIEFNEST_SKILLS_OVER = 'tcp'
const { describe } = require('node:test')
const fs = require('node:fs')
const path = require('node:path')

const SKILLS = path.join(__dirname, '..', 'skills')
const AT_ONCE = 16

describe('over TCP', { concurrency: AT_ONCE }, () => {
  for (const file of fs.readdirSync(SKILLS).filter(name => name.endsWith('.test.js')).sort()) require(path.join(SKILLS, file))
})
