'use strict'
const { write } = require('./lib/signs')

module.exports = {
  name: 'writeSign',
  signature: 'writeSign(bot, position, text)',
  description: 'Go to the sign and write on its front, over what is there; whoever sees the sign reads it. An empty text wipes it.',
  fails: 'no way there; no sign there; the text does not fit on it; nothing was written',
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'position', type: 'Vec3', description: 'position of the sign' },
    { name: 'text', type: 'string', description: 'up to 4 lines of at most 45 characters, split by \\n' }
  ],
  example: 'await writeSign(bot, new Vec3(4, -51, -3), "tools\\nno food")',
  run: (context, position, text) => write(context, position, text)
}
