'use strict'
const { text } = require('./lib/arguments')

module.exports = {
  name: 'think',
  signature: 'think(bot, msg)',
  description: 'Think something to yourself. Nobody else perceives it.',
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'msg', type: 'string', description: 'the thought' }
  ],
  example: 'await think(bot, "Where is the diamond?")',
  async run (context, msg) {
    context.emit({ kind: 'think', detail: { text: text(context, 'msg', msg) } })
  }
}
