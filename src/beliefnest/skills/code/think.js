'use strict'
const { utterance } = require('./lib/speech')

module.exports = {
  name: 'think',
  scripted: true,
  cost: 'message',
  description: 'Think something to yourself. Nobody else perceives it.',
  fails: 'the text is not one line of at most 256 characters',
  parameters: [
    { name: 'msg', type: 'string', description: 'the thought' }
  ],
  example: 'await think(bot, "Where is the diamond?")',
  check: (context, msg) => [utterance(context, 'msg', msg)],
  async run (context, text) {
    context.emit({ kind: 'think', detail: { text } })
  }
}
