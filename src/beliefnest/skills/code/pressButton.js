'use strict'
const { blockPosition } = require('./lib/arguments')
const { pressButton } = require('./lib/switches')

module.exports = {
  name: 'pressButton',
  scripted: true,
  description: 'Go to the button and press it; it comes out again by itself.',
  fails: 'there is no path on foot; there is no button; it stays pressed, or did not move',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the button', aim: 'uses', action: ['button'] }
  ],
  example: 'await pressButton(bot, new Vec3(3, -50, 0))',
  check: (context, position) => [blockPosition(context, 'position', position)],
  run: pressButton
}
