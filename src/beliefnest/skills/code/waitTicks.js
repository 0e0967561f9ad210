'use strict'
const { count } = require('./lib/arguments')
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'waitTicks',
  scripted: true,
  description: 'Wait for a number of ticks; 20 are a second.',
  fails: 'only for invalid arguments',
  parameters: [
    { name: 'number', type: 'number', description: 'how many ticks' }
  ],
  example: 'await waitTicks(bot, 20)',
  check: (context, number) => [count(context, 'number', number)],
  run: ticks
}
