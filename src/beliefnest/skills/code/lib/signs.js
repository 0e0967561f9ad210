'use strict'
const { show } = require('./arguments')
const { answered } = require('./answers')
const { isUnseen, nameOf } = require('./known')
const { signFlawOf } = require('./text')
const { walkToUse } = require('./walking')

/** Return the current state of the sign at a position; fail if there is no sign. @returns {object} */
function signAt ({ bot, fail }, position) {
  const sign = bot.blockAt(position)
  if (!sign?.name.endsWith('_sign')) {
    fail(`there is no sign at ${show(position)}, but ${nameOf(bot, sign)}. Give the position of a sign.`)
  }
  return sign
}

/** Return the text on the front of a sign, without empty lines at the end. @returns {string} */
function textOf (sign) {
  return sign.entity ? sign.getSignText()[0].replace(/\n+$/, '') : ''
}

/** Return the text that a program wants on a sign, without empty lines at the end; fail if it cannot be written. */
function signText ({ fail }, lines, claims) {
  const text = Array.isArray(lines) && lines.every(line => typeof line === 'string') ? lines.join('\n') : lines
  if (typeof text !== 'string') fail(`text must be a text; it is ${show(text)}`)
  const flaw = signFlawOf(text)
  if (flaw !== null) fail(`text ${flaw}.`)
  const wanted = text.replace(/\n+$/, '')
  if (Array.isArray(claims) && claims.length > 0 && wanted === '') fail('an empty text cannot claim anything. Write a text, or leave out the claims.')
  return wanted
}

/** Go to a sign and replace its text; do nothing if the sign has this text already. */
async function write (context, position, wanted, claims) {
  const { bot, fail, emit } = context
  if (!isUnseen(bot, position)) signAt(context, position)
  await walkToUse(context, position, 'the sign')
  if (textOf(signAt(context, position)) === wanted) return
  await bot.activateBlock(signAt(context, position))
  await answered(context)
  if (claims.length > 0) emit({ kind: 'claims', detail: { text: wanted, position: [position.x, position.y, position.z], claims } })
  bot.updateSign(signAt(context, position), wanted)
  await answered(context)
  if (textOf(signAt(context, position)) !== wanted) fail(`nothing was written on the sign at ${show(position)}. Go nearer and try again.`)
}

/** Look at a sign and return its text. */
async function read (context, position) {
  signAt(context, position)
  await context.bot.lookAt(position.offset(0.5, 0.5, 0.5))
  return textOf(signAt(context, position))
}

module.exports = { read, signText, textOf, write }
