'use strict'
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'doNothing',
  scripted: true,
  description: 'Do nothing for one tick.',
  fails: 'never',
  parameters: [],
  example: 'await doNothing(bot)',
  check: () => [],
  run: context => ticks(context, 1)
}
