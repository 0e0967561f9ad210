'use strict'
const { blockPosition } = require('./lib/arguments')
const { switchLever } = require('./lib/switches')

module.exports = {
  name: 'turnOnLever',
  scripted: true,
  description: 'Go to the lever and switch it on; does nothing if it is on already.',
  fails: 'there is no path on foot; there is no lever; it did not move',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the lever', aim: 'uses', action: ['lever'] }
  ],
  example: 'await turnOnLever(bot, new Vec3(3, -50, 0))',
  check: (context, position) => [blockPosition(context, 'position', position)],
  run: (context, position) => switchLever(context, position, true)
}
