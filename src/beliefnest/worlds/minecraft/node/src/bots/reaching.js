'use strict'
/** Immediate failure of uses of blocks that are out of reach, or do not open. The server itself would not answer them. */
const { show } = require('../../../../../skills/code/lib/arguments')
const { hindranceOf } = require('../../../../../skills/code/lib/sight')
const { onLid } = require('../server/plugins/lib/onLid')
const { blockStates } = require('../server/plugins/lib/states')

const AIR = 0

/** Methods that use a block, each with the position that must be visible for it. */
const USES = {
  activateBlock: block => block,
  openBlock: block => block,
  dig: block => block,
  craft: (recipe, count, table) => table
}

/** Make the bot's methods that use blocks reject where the server would refuse them. */
function refuseUnreachable (bot) {
  const { describe } = blockStates(bot.registry)
  const at = position => describe(bot.blockAt(position)?.stateId ?? AIR)
  const { openBlock } = bot
  bot.openBlock = async (block, ...rest) => {
    const above = block?.position ? onLid(at, block.position) : undefined
    if (above !== undefined) throw new Error(`the chest at ${show(block.position)} cannot be opened: ${above.name} lies on its lid. Remove it first.`)
    return openBlock(block, ...rest)
  }
  const check = (name, position) => {
    const why = hindranceOf(bot, position)
    if (why !== null) throw new Error(`${name} at (${position.x}, ${position.y}, ${position.z}) cannot be reached from here: ${why}`)
  }
  for (const [call, used] of Object.entries(USES)) {
    const original = bot[call]
    bot[call] = async (...args) => {
      const block = used(...args)
      if (block?.position) check(block.name, block.position)
      return original(...args)
    }
  }
  const { placeBlock } = bot
  bot.placeBlock = async (reference, face) => {
    if (reference?.position && face) check('the place', reference.position.plus(face))
    return placeBlock(reference, face)
  }
}

module.exports = { refuseUnreachable }
