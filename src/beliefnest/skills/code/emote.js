'use strict'
const { show } = require('./lib/arguments')
const { utterance } = require('./lib/speech')

module.exports = {
  name: 'emote',
  cost: 'message',
  takesBot: false,
  description: 'Make a gesture, such as "wave" or "nod". Agents that see you perceive it.',
  fails: 'nobody has that name; the gesture is not one line of at most 256 characters',
  parameters: [
    { name: 'name', type: 'string', description: 'your own name, or the name of the agent the gesture is meant for' },
    { name: 'type', type: 'string', description: 'which gesture' }
  ],
  example: 'await emote("sally", "wave")',
  async run (context, name, type) {
    const { bot, fail, emit } = context
    if (!Object.keys(bot.players).includes(name)) {
      fail(`name must be the name of an agent; it is ${show(name)}. Agents here: ${Object.keys(bot.players).toSorted().join(', ')}`)
    }
    const detail = { name: utterance(context, 'type', type) }
    emit({ kind: 'emote', detail: name === bot.username ? detail : { ...detail, other: name } })
    bot.swingArm('right')
  }
}
