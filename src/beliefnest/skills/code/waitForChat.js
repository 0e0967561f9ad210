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
  check: (context, number = 100) => [count(context, 'number', number)],
  async run (context, limit) {
    const { bot, listen } = context
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
