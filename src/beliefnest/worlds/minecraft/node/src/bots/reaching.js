'use strict'
/** Immediate failure of block uses that are out of reach. The server itself would not answer them. */
const { hindranceOf } = require('../../../../../skills/code/lib/sight')

/** Methods that use a block, each with the position that must be visible for it. */
const USES = {
  activateBlock: block => block,
  openBlock: block => block,
  dig: block => block,
  craft: (recipe, count, table) => table
}

/** Make the bot's methods that use blocks reject where the server would refuse them. */
function refuseUnreachable (bot) {
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
