'use strict'
const { blockPosition } = require('./lib/arguments')
const { read } = require('./lib/signs')

module.exports = {
  name: 'readSign',
  scripted: true,
  description: 'Look at the sign, without going there, and get what is written on it, lines split by \\n; empty if nothing is.',
  fails: 'there is no sign, or you cannot see it',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the sign' }
  ],
  example: 'const text = await readSign(bot, new Vec3(4, -51, -3))',
  check: (context, position) => [blockPosition(context, 'position', position)],
  run: (context, position) => read(context, position)
}
