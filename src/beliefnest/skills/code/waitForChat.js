'use strict'
const { count } = require('./lib/arguments')
const { until } = require('./lib/waiting')

module.exports = {
  name: 'waitForChat',
  scripted: true,
  description: 'Wait until somebody else says something that you hear, and return {speaker, text, whispered}; null if nobody does ' +
    'within a number of ticks.',
  fails: 'only for invalid arguments',
  parameters: [
    { name: 'number', type: 'number', description: 'how many ticks at most', default: '100' }
  ],
  example: 'const answer = await waitForChat(bot, 200)',
  async run (context, number = 100) {
    const { bot, listen } = context
    const limit = count(context, 'number', number)
    let heard = null
    const hear = whispered => (speaker, text) => {
      if (speaker !== bot.username) heard ??= { speaker, text, whispered }
    }
    const stops = [listen('chat', hear(false)), listen('whisper', hear(true))]
    try {
      await until(context, () => heard !== null, limit)
    } finally {
      for (const stop of stops) stop()
    }
    return heard
  }
}
