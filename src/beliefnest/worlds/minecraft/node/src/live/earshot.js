'use strict'
/**
 * Delivery of speech to people. Only Python decides who hears a line; a person receives a line after Python has said
 * that their agent heard it.
 */

class Earshot {
  /**
   * @param {object} serv
   * @param {(agent: string) => object | null} personOf returns the player of a person; null if a bot plays the agent
   */
  constructor (serv, personOf) {
    this.personOf = personOf
    // True if everybody hears everything; lines are then sent at once.
    this.isGlobal = false
    // Lines that no frame contains yet, oldest first.
    this.said = []
    // {tick, lines} of frames for which Python has not yet said who heard them.
    this.waiting = []
    serv.tellSaid = (speaker, text) => {
      for (const player of serv.players) {
        if (this.isGlobal || player === speaker || personOf(player.agent) !== player) player.system(text)
      }
      this.said.push({ speaker: speaker.agent, text })
    }
  }

  /** Move the lines that a frame contains to the waiting ones. */
  framed ({ tick, events }) {
    const count = events.filter(({ kind, detail }) => kind === 'chat' && detail.to === undefined).length
    if (count > 0) this.waiting.push({ tick, lines: this.said.splice(0, count) })
  }

  /**
   * Deliver the lines of a frame to the people who heard them.
   * @param {number} tick tick of the frame
   * @param {string[][]} heard the agents that heard each of its lines
   */
  hear ({ tick, heard }) {
    while (this.waiting.length > 0 && this.waiting[0].tick <= tick) {
      const { tick: spoken, lines } = this.waiting.shift()
      if (spoken === tick && !this.isGlobal) lines.forEach((line, index) => this.tell(line, heard[index] ?? []))
    }
  }

  tell ({ speaker, text }, agents) {
    for (const agent of agents) if (agent !== speaker) this.personOf(agent)?.system(text)
  }

  /** Forget lines of a past that was discarded. */
  forget () {
    this.said.length = 0
    this.waiting.length = 0
  }
}

module.exports = { Earshot }
