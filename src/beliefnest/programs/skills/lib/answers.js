'use strict'
/**
 * Waiting for the server's word. A bot shows what it does before the server has heard of it: a block
 * it mined is gone, an item it clicked has moved. On a server that is far away that may be undone
 * later, and what comes of it (what a block drops) is not there yet.
 */
const ANSWER_TICKS = 600
const CANCEL_DIGGING = 1
const FACE_DOWN = 0
// Mineflayer numbers what it asks from 0.
const FIRST = 1_000_000

/** @returns {() => number} numbers of questions, each once */
function numbers () {
  let next = FIRST
  return () => next++
}

/** @returns {Promise<boolean>} true if the server acknowledged what has this number, or a later one, in time */
function acknowledged ({ bot: { _client: client }, wait }, number) {
  const ended = new AbortController()
  return new Promise(resolve => {
    const end = outcome => {
      client.removeListener('acknowledge_player_digging', onAcknowledged)
      ended.abort()
      resolve(outcome)
    }
    const onAcknowledged = ({ sequenceId }) => { if (sequenceId >= number) end(true) }
    wait(ANSWER_TICKS, ended.signal).then(() => end(false))
    client.on('acknowledge_player_digging', onAcknowledged)
  })
}

/**
 * Resolve when the server has done all that the bot has asked for so far, and the bot knows what
 * came of it. Servers acknowledge acts on blocks at the end of the tick in which they come, after
 * all else that came of that tick; this act is one that does nothing.
 */
async function answered (context) {
  const { bot, fail, nextNumber } = context
  const number = nextNumber()
  const answer = acknowledged(context, number)
  const location = bot.entity.position.floored()
  bot._client.write('block_dig', { status: CANCEL_DIGGING, location, face: FACE_DOWN, sequence: number })
  if (!await answer) fail(`the server did not answer within ${ANSWER_TICKS} ticks.`)
  if (bot.perceived !== undefined) await bot.perceived()
}

module.exports = { answered, numbers }
