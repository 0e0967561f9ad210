'use strict'
const { otherAgent } = require('./lib/arguments')
const { claims: checked, PARAMETER } = require('./lib/claims')
const { speech } = require('./lib/speech')
const { LONGEST_WHISPER } = require('./lib/text')
const { ticks } = require('./lib/waiting')

module.exports = {
  name: 'whisper',
  scripted: true,
  cost: 'message',
  description: `Say something to one other agent alone, in at most ${LONGEST_WHISPER} characters. Nobody else perceives it. Claims as for say.`,
  fails: 'nobody has that name; the text is not one such line, or is empty; a claim is invalid',
  parameters: [
    { name: 'otherName', type: 'string', description: 'name of the agent that hears it', action: ['agent'] },
    { name: 'msg', type: 'string', description: 'what to say', action: ['phrase'] },
    PARAMETER
  ],
  example: 'await whisper(bot, "anne", "The diamond is in the left chest.", [located("diamond", new Vec3(2, -51, -4))])',
  check: (context, otherName, msg, claims) =>
    [otherAgent(context, 'otherName', otherName), speech(context, 'msg', msg, LONGEST_WHISPER), checked(context, claims)],
  async run (context, to, text, claims) {
    if (claims.length > 0) context.emit({ kind: 'claims', detail: { text, to, claims } })
    await context.bot.whisper(to, text)
    await ticks(context, 1)
  }
}
