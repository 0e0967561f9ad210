'use strict'
const { blockPosition, show } = require('./arguments')
const { walkToUse } = require('./walking')
const { answered } = require('./answers')

/** Goes to a lever and brings it into a state; does nothing if it is in it already. */
async function switchLever (context, leverPosition, powered) {
  const { bot, fail } = context
  const position = blockPosition(context, 'position', leverPosition)
  const lever = () => {
    const block = bot.blockAt(position)
    if (block?.name !== 'lever') {
      fail(`there is no lever at ${show(position)}, but ${block ? block.name : 'nothing that is loaded'}. Give the position of a lever.`)
    }
    return block
  }
  lever()
  await walkToUse(context, position, 'the lever')
  if (lever().getProperties().powered === powered) return
  await bot.activateBlock(lever())
  await answered(context)
  if (lever().getProperties().powered !== powered) fail(`the lever at ${show(position)} did not move. Go nearer and try again.`)
}

module.exports = { switchLever }
