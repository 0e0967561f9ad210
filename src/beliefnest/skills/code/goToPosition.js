'use strict'
const { position: checkPosition, distance, flags } = require('./lib/arguments')
const { walkNear } = require('./lib/walking')

const DOORS = { openDoors: true, closeDoors: false }

module.exports = {
  name: 'goToPosition',
  scripted: true,
  description: 'Walk until the position is at most dist blocks away. Goes through open doors of any kind and opens shut doors on its way, except iron ones; a fourth argument {openDoors: false, closeDoors: true} keeps it from opening any, and lets it shut those it goes through. Fails, saying how near it came, if there is no way on foot.',
  fails: 'there is no path on foot (`reason` is `no_way`); you were stopped on the way (the error says where you are)',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'where to go', aim: 'walks', action: ['position'] },
    { name: 'dist', type: 'number', description: 'greatest distance at the end, in blocks; 0: stand in exactly this block', default: '2', action: 0 }
  ],
  example: 'await goToPosition(bot, new Vec3(0, -51, -8))',
  check: (context, position, dist = 2, doors = {}) =>
    [checkPosition(context, 'position', position), distance(context, 'dist', dist), flags(context, 'doors', doors, DOORS)],
  async run (context, target, near, doors) {
    await walkNear(context, target, near, 'the position', doors)
    context.emit({ kind: 'move_to', detail: { destination: [target.x, target.y, target.z] } })
  }
}
