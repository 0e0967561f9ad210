'use strict'
/**
 * What people are told of what is said. Who hears what is worked out in Python alone: what others have said reaches a
 * person once Python has said that the agent they play heard it.
 */

class Earshot {
  /**
   * @param {object} serv
   * @param {(agent: string) => object | null} personOf the player of a person; null if a bot plays the agent
   */
  constructor (serv, personOf) {
    this.personOf = personOf
    // Whether everybody hears everything, so that nothing has to wait.
    this.isGlobal = false
    // Lines that no frame has told yet, oldest first.
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

  /** Take note of the frame that tells what was said. */
  framed ({ tick, events }) {
    const count = events.filter(({ kind, detail }) => kind === 'chat' && detail.to === undefined).length
    if (count > 0) this.waiting.push({ tick, lines: this.said.splice(0, count) })
  }

  /**
   * Tell people what they heard.
   * @param {number} tick of the frame
   * @param {string[][]} heard by whom, for each thing said aloud in it
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

  /** Forget what was said in what has not happened. */
  forget () {
    this.said.length = 0
    this.waiting.length = 0
  }
}

module.exports = { Earshot }
