'use strict'
/** Standstill of time: acts of people's clients have no effect while it lasts. */

const MOVES = ['position', 'position_look']
const SPEECH = ['chat_message', 'chat_command', 'chat_command_signed']
// Packets about the client itself, and packets with no visible effect.
const HARMLESS = ['keep_alive', 'teleport_confirm', 'settings', 'pong', 'custom_payload', 'chunk_batch_received', 'message_acknowledgement', 'chat_session_update']
const IDLE = ['look', 'flying', 'arm_animation', 'entity_action']

class Standstill {
  constructor () {
    this.isOn = false
    // Connections whose clients show an act that did not happen.
    this.missed = new Set()
  }

  /** Return true if a packet of a person's client must be dropped; tell the person in that case. @returns {boolean} */
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

  /**
   * End the standstill. Return the connections that must be set up again, because their clients show something that
   * never happened.
   * @returns {object[]}
   */
  end () {
    this.isOn = false
    const anew = [...this.missed]
    this.missed.clear()
    return anew
  }
}

module.exports = { Standstill }
