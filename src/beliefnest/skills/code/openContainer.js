'use strict'
const { blockPosition } = require('./lib/arguments')
const { withContainer } = require('./lib/chests')

module.exports = {
  name: 'openContainer',
  scripted: true,
  listed: false,
  description: 'Go to a container, open it, look in, close it.',
  fails: 'there is no path on foot; there is no container; its lid is blocked',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of a chest or barrel', aim: 'uses', action: ['container'] }
  ],
  example: 'await openContainer(bot, new Vec3(2, -51, -4))',
  check: (context, position) => [blockPosition(context, 'position', position)],
  async run (context, position) {
    await withContainer(context, position, () => {})
  }
}
