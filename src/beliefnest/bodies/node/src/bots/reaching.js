'use strict'
/** What a bot says at once when something cannot be used from where it stands, for the server does not answer that. */
const { hindranceOf } = require('../../../../programs/skills/lib/sight')

/** Calls that use a block, with the place of what has to be seen for them. */
const USES = {
  activateBlock: block => block,
  openBlock: block => block,
  dig: block => block,
  craft: (recipe, count, table) => table
}

/** Let the bot's calls that use blocks reject where the server would refuse them. */
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
