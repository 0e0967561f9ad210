'use strict'
const { blockPosition } = require('./lib/arguments')
const { claims: checked, PARAMETER } = require('./lib/claims')
const { signText, write } = require('./lib/signs')

module.exports = {
  name: 'writeSign',
  scripted: true,
  cost: 'message',
  description: 'Go to the sign and write on its front, over what is there; whoever sees the sign reads it. An empty text wipes it. ' +
    'You can also give the facts that it states as claims. An agent that reads the text for the first time may believe them.',
  fails: 'there is no path on foot; there is no sign; the text does not fit on it; the sign did not change; a claim is invalid, or there are more than 16',
  parameters: [
    { name: 'position', type: 'Vec3', description: 'position of the sign', aim: 'uses', action: ['sign'] },
    { name: 'lines', type: 'string', description: 'up to 4 lines of at most 45 characters, split by \\n, or a list of lines', action: ['phrase'] },
    PARAMETER
  ],
  example: 'await writeSign(bot, new Vec3(4, -51, -3), "tools\\nno food")',
  check: (context, position, lines, claims) => [blockPosition(context, 'position', position), signText(context, lines, claims), checked(context, claims)],
  run: write
}
