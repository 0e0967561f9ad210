'use strict'
/** Player that marks where an agent is believed to be. The operator moves it; it does nothing itself. */
const { Link } = require('./link')

const SLOTS = { main_hand: 36, off_hand: 45, head: 5, chest: 6, legs: 7, feet: 8 }

class Marker {
  /**
   * @param {string} name name of the player
   * @param {() => object} connect begins its connection
   * @param {import('./operator').Operator} operator
   * @param {object} commands commands of the exhibit
   */
  constructor (name, connect, operator, commands) {
    this.name = name
    this.operator = operator
    this.commands = commands
    this.pose = null
    this.worn = {}
    this.link = new Link(name, connect, operator.server, operator.server.patience * 1000, () => this.begin())
    this.link.on('failed', error => process.stderr.write(`${name}: ${error.message}\n`))
  }

  /** Let the marker join. @throws {Unplayable} if the server refuses it */
  async open (pose) {
    this.pose = pose
    await this.link.open()
  }

  /** Prepare the marker so that neither gravity nor hunger affects it. */
  async begin () {
    this.operator.type(this.commands.mode(this.name, 'creative'))
    this.operator.type(this.commands.clear(this.name))
    this.worn = {}
    this.show()
  }

  move (pose) {
    this.pose = pose
    if (this.link.isReady) this.show()
  }

  show () {
    const { pose, commands, operator } = this
    operator.type(commands.go(this.name, pose.position, pose))
    for (const [part, slot] of Object.entries(SLOTS)) {
      const item = pose.equipment[part]
      if (item === this.worn[part]) continue
      operator.type(commands.wear(this.name, slot, item === undefined ? null : { name: item, count: 1 }))
    }
    this.worn = pose.equipment
  }

  async close () {
    await this.link.close()
  }
}

module.exports = { Marker }
