'use strict'
const { otherAgent } = require('./lib/arguments')
const { speech } = require('./lib/speech')
const { ticks } = require('./lib/waiting')

// With the longest name there is, it fits into one message of the game.
const LONGEST = 230

module.exports = {
  name: 'whisper',
  signature: 'whisper(bot, otherName, msg)',
  description: `Say something to one other agent alone, in at most ${LONGEST} characters. Nobody else perceives it.`,
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'otherName', type: 'string', description: 'who is to hear it' },
    { name: 'msg', type: 'string', description: 'what to say' }
  ],
  example: 'await whisper(bot, "anne", "The diamond is in the left chest.")',
  async run (context, otherName, msg) {
    context.bot.whisper(otherAgent(context, 'otherName', otherName), speech(context, 'msg', msg, LONGEST))
    await ticks(1)
  }
}
