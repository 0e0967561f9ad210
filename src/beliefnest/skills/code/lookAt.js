'use strict'
const { position: checkPosition } = require('./lib/arguments')
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'lookAt',
  scripted: true,
  description: 'Turn to look at a point.',
  fails: 'only for invalid arguments',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'what to look at' }
  ],
  example: 'await lookAt(bot, new Vec3(2.5, -50, -3.5))',
  check: (context, position) => [checkPosition(context, 'position', position)],
  async run (context, position) {
    await context.bot.lookAt(position, true)
    await ticks(context, 1)
  }
}
