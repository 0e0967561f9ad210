'use strict'
const { blockPosition } = require('./lib/arguments')
const { useDoor } = require('./lib/switches')

module.exports = {
  name: 'closeDoor',
  scripted: true,
  description: 'Go to the door, trapdoor or fence gate and shut it; does nothing if it is shut already. Iron ones move by levers and buttons alone.',
  fails: 'there is no path on foot; there is no door, trapdoor or gate; it is an iron one; it did not move',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the door, of either half', aim: 'uses', action: ['door'] }
  ],
  example: 'await closeDoor(bot, new Vec3(4, -51, -3))',
  check: (context, position) => [blockPosition(context, 'position', position)],
  run: (context, position) => useDoor(context, position, false)
}
