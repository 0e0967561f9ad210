'use strict'
/** The skills' own tests, repeated on a server in another process, over TCP, in real time. */
process.env.BELIEFNEST_SKILLS_OVER = 'tcp'
const { describe } = require('node:test')
const fs = require('node:fs')
const path = require('node:path')

const SKILLS = path.join(__dirname, '..', 'skills')
// By day every other file: what differs over TCP is the way to the bot, not the skill.
const STEP = process.env.BELIEFNEST_NIGHTLY === '1' ? 1 : 2
const AT_ONCE = 16

describe('over TCP', { concurrency: AT_ONCE }, () => {
  const files = fs.readdirSync(SKILLS).filter(name => name.endsWith('.test.js')).sort()
  for (const file of files.filter((_, number) => number % STEP === 0)) require(path.join(SKILLS, file))
})
