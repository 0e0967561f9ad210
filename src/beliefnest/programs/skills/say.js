'use strict'
const { speech } = require('./lib/speech')
const { ticks } = require('./lib/waiting')

const LONGEST = 256

module.exports = {
  name: 'say',
  signature: 'say(bot, msg)',
  description: 'Say something aloud, in at most 256 characters.',
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'msg', type: 'string', description: 'what to say' }
  ],
  example: 'await say(bot, "Hello, Anne!")',
  async run (context, msg) {
    context.bot.chat(speech(context, 'msg', msg, LONGEST))
    await ticks(1)
  }
}
