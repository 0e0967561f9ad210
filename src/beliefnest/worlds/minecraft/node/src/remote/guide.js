'use strict'
/** Player that observes a distant area for the operator. The operator types the commands for it. */
const { Operator } = require('./operator')

class Guide extends Operator {
  /**
   * @param {import('./link').Link} link link of the guide
   * @param {Operator} operator
   */
  constructor (link, operator) {
    super(link, operator.server, operator.clock, operator.settling)
    this.operator = operator
  }

  type (command) {
    this.operator.type(command)
  }

  can (name) {
    return this.operator.can(name)
  }

  ask (command) {
    return this.operator.ask(command)
  }

  /** Resolve when the operator's commands are done and the guide has received their effects. */
  async settled () {
    await this.operator.settled()
    await super.settled()
  }
}

module.exports = { Guide }
