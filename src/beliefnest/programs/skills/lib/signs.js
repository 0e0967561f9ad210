'use strict'
const { blockPosition, show } = require('./arguments')
const { answered } = require('./answers')
const { isUnseen, nameOf } = require('./known')
const { signFlawOf } = require('./text')
const { walkToUse } = require('./walking')

/** @returns {object} the sign at a position, looked up anew */
function signAt ({ bot, fail }, position) {
  const found = bot.blockAt(position)
  if (!found?.name.endsWith('_sign')) {
    fail(`there is no sign at ${show(position)}, but ${nameOf(bot, found)}. Give the position of a sign.`)
  }
  return found
}

/** @returns {string} what is written on the front of a sign, without empty lines at the end */
function textOf (sign) {
  return sign.entity ? sign.getSignText()[0].replace(/\n+$/, '') : ''
}

/** Goes to a sign and writes on it, over what is there. */
async function write (context, signPosition, text) {
  const { bot, fail } = context
  const position = blockPosition(context, 'position', signPosition)
  if (typeof text !== 'string') fail(`text must be a text; it is ${show(text)}`)
  const flaw = signFlawOf(text)
  if (flaw !== null) fail(`text ${flaw}.`)
  const wanted = text.replace(/\n+$/, '')
  if (!isUnseen(bot, position)) signAt(context, position)
  await walkToUse(context, position, 'the sign')
  if (textOf(signAt(context, position)) === wanted) return
  await bot.activateBlock(signAt(context, position))
  await answered(context)
  bot.updateSign(signAt(context, position), wanted)
  await answered(context)
  if (textOf(signAt(context, position)) !== wanted) fail(`nothing was written on the sign at ${show(position)}. Go nearer and try again.`)
}

/** Looks at a sign and gives what is written on it. */
async function read (context, signPosition) {
  const position = blockPosition(context, 'position', signPosition)
  signAt(context, position)
  await context.bot.lookAt(position.offset(0.5, 0.5, 0.5))
  return textOf(signAt(context, position))
}

module.exports = { read, textOf, write }
