'use strict'
const { blockPosition } = require('./lib/arguments')

const passable = block => block !== null && block.boundingBox === 'empty' && block.name !== 'lava'

module.exports = {
  name: 'checkValidPosition',
  description: 'Return true if an agent can stand at the position: two free blocks above a solid one.',
  fails: 'only for invalid arguments',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'where the feet would be' },
    { name: 'bot', type: 'Bot', description: 'your own bot' }
  ],
  example: 'const free = await checkValidPosition(new Vec3(3, -51, 3), bot)',
  async run (context, position) {
    const feet = blockPosition(context, 'position', position)
    const at = height => context.bot.blockAt(feet.offset(0, height, 0))
    return passable(at(0)) && passable(at(1)) && at(-1)?.boundingBox === 'block'
  }
}
