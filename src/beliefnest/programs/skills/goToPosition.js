'use strict'
const { position: checkPosition, distance } = require('./lib/arguments')
const { walkNear } = require('./lib/walking')

module.exports = {
  name: 'goToPosition',
  signature: 'goToPosition(bot, position, dist=2)',
  description: 'Walk until the position is at most dist blocks away. Fails, saying how near it came, if there is no way on foot.',
  parameters: [
    { name: 'bot', type: 'Bot', description: 'your own bot' },
    { name: 'position', type: 'Vec3', description: 'where to go' },
    { name: 'dist', type: 'number', description: 'how near is near enough, in blocks; 0 is the very block' }
  ],
  example: 'await goToPosition(bot, new Vec3(0, -51, -8))',
  async run (context, position, dist = 2) {
    const target = checkPosition(context, 'position', position)
    await walkNear(context, target, distance(context, 'dist', dist))
    context.emit({ kind: 'move_to', detail: { destination: [target.x, target.y, target.z] } })
  }
}
