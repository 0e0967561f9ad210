'use strict'
/**
 * Check that a person's client still answers. It is measured in this process's own time (time/ownTime.js), so that a
 * process without a processor disconnects nobody; the library's own check reads the date.
 */

// As in the game.
const ASKED_EVERY_MS = 4000
const SILENCE_MS = 30_000

/**
 * Ask a client again and again whether it is there; end its connection when it has not answered for a time.
 * @param {import('minecraft-protocol').Client} client
 * @param {() => number} now returns milliseconds of own time
 */
function keepAlive (client, now = () => performance.now()) {
  let heardAt = now()
  const asking = setInterval(() => {
    if (now() - heardAt > SILENCE_MS) client.end('Your game has not answered for a while')
    else client.write('keep_alive', { keepAliveId: Math.floor(now()) })
  }, ASKED_EVERY_MS)
  client.on('keep_alive', () => { heardAt = now() })
  client.on('end', () => clearInterval(asking))
}

module.exports = { keepAlive }
