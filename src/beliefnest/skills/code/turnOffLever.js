'use strict'
const { blockPosition } = require('./lib/arguments')
const { switchLever } = require('./lib/switches')

module.exports = {
  name: 'turnOffLever',
  scripted: true,
  description: 'Go to the lever and switch it off; does nothing if it is off already.',
  fails: 'there is no path on foot; there is no lever; it did not move',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the lever', aim: 'uses', action: ['lever'] }
  ],
  example: 'await turnOffLever(bot, new Vec3(3, -50, 0))',
  check: (context, position) => [blockPosition(context, 'position', position)],
  run: (context, position) => switchLever(context, position, false)
}
