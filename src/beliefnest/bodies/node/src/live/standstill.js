'use strict'
/** A time in which nothing happens: what people's clients send meanwhile is not done. */

const MOVES = ['position', 'position_look']
const SPEECH = ['chat_message', 'chat_command', 'chat_command_signed']
// What a client says of itself, and what shows to nobody.
const HARMLESS = ['keep_alive', 'teleport_confirm', 'settings', 'pong', 'custom_payload', 'chunk_batch_received', 'message_acknowledgement', 'chat_session_update']
const IDLE = ['look', 'flying', 'arm_animation', 'entity_action']

class Standstill {
  constructor () {
    this.isOn = false
    // Ends whose client holds something to be done that was not.
    this.missed = new Set()
  }

  /** @returns {boolean} true if what a person's client sent must not be done, which it is told */
  takes ({ player }, name, { x, y, z }) {
    if (!this.isOn || player === null || HARMLESS.includes(name)) return false
    if (MOVES.includes(name)) {
      const { x: ownX, y: ownY, z: ownZ } = player.position
      if (x !== ownX || y !== ownY || z !== ownZ) player.sendSelfPosition()
    } else if (SPEECH.includes(name)) {
      player.system('Time stands still: nobody hears you. Say it again when it goes on.')
    } else if (!IDLE.includes(name)) {
      this.missed.add(player._client)
    }
    return true
  }

  /** @returns {object[]} the ends of people who are to come in anew, since their client shows what never was */
  end () {
    this.isOn = false
    const anew = [...this.missed]
    this.missed.clear()
    return anew
  }
}

module.exports = { Standstill }
