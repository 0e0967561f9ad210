'use strict'
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'doNothing',
  scripted: true,
  description: 'Do nothing for one tick.',
  fails: 'never',
  parameters: [{ name: 'bot', type: 'Bot', description: 'your own bot' }],
  example: 'await doNothing(bot)',
  run: context => ticks(context, 1)
}
