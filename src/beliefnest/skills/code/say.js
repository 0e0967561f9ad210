'use strict'
const { claims: checked, PARAMETER } = require('./lib/claims')
const { speech } = require('./lib/speech')
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'say',
  scripted: true,
  cost: 'message',
  description: 'Say something aloud, in at most 256 characters. You can also give the facts that it states as claims, ' +
    'such as [located("diamond", new Vec3(2, -51, -4))]. Hearers may believe claims.',
  fails: 'the text is not one line of at most 256 characters, is empty, or begins with a slash; a claim is invalid, or there are more than 16',
  parameters: [
    { name: 'msg', type: 'string', description: 'what to say', action: ['phrase'] },
    PARAMETER
  ],
  example: 'await say(bot, "Hello, Anne! The diamond is here.", [located("diamond", new Vec3(2, -51, -4))])',
  check: (context, msg, claims) => [speech(context, 'msg', msg), checked(context, claims)],
  async run (context, text, claims) {
    if (claims.length > 0) context.emit({ kind: 'claims', detail: { text, claims } })
    await context.bot.chat(text)
    await ticks(context, 1)
  }
}
