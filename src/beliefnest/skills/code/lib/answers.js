'use strict'
/**
 * Waiting for the server's acknowledgement. A bot shows the effect of an act before the server has received it: a
 * mined block is gone, a clicked item has moved. A remote server may undo this later, and further effects, such as the
 * items that a block drops, arrive only with its answer.
 */
const ANSWER_TICKS = 600
const CANCEL_DIGGING = 1
const FACE_DOWN = 0
// Numbers of our own requests. Mineflayer numbers its requests from 0, so ours begin far above.
const FIRST = 1_000_000

/** Return a function that returns a new request number on each call. @returns {() => number} */
function numbers () {
  let next = FIRST
  return () => next++
}

/**
 * Wait until the server acknowledges a request.
 * @returns {Promise<boolean>} true if the server acknowledged this number, or a later one, in time
 */
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
 * Resolve when the server has handled all requests of the bot so far and the bot has received their effects.
 *
 * A server acknowledges block acts at the end of the tick in which they arrive, after all other effects of that tick.
 * This function sends a block act that does nothing and waits for its acknowledgement.
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
