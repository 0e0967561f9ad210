'use strict'
const { blockPosition, block: checkBlock } = require('./lib/arguments')
const { mine } = require('./lib/mining')

module.exports = {
  name: 'mineBlock',
  scripted: true,
  description: 'Go to the block, mine it with the best tool you carry, and pick up what it drops.',
  fails: 'there is no path on foot; another block is there; the block cannot be mined, or not with your tools; the inventory has no room for the drops',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the block', aim: 'uses' },
    { name: 'name', type: 'string', description: 'name of the block that is there' }
  ],
  example: 'await mineBlock(bot, new Vec3(4, -51, 2), "oak_log")',
  check: (context, position, name) => [blockPosition(context, 'position', position), checkBlock(context, 'name', name)],
  async run (context, place, { name }) {
    await mine(context, place, name)
  }
}
