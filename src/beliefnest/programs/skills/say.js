'use strict'
const { text, show } = require('./lib/arguments')
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
    const words = text(context, 'msg', msg)
    if (words.startsWith('/')) context.fail(`msg must not begin with a slash, agents have no commands; it is ${show(words)}`)
    if (/[\n\r]/.test(words)) context.fail(`msg must be one line; it is ${show(words)}. Say the lines one after the other.`)
    if (words.length > LONGEST) context.fail(`msg must have at most ${LONGEST} characters; it has ${words.length}. Say it in parts.`)
    context.bot.chat(words)
    await ticks(1)
  }
}
